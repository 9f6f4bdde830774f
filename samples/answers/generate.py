"""The three files of answers: one all right, one with usual slips, one left half empty."""

from pathlib import Path

from robomill.learn import answers_text, exercises
from robomill.units import from_si

FOLDER = Path(__file__).parent / "class"


def typed(student: str, change: dict[str, str]) -> dict[str, str]:
    """All answers right, to five digits, but for the ``change``."""
    return {each.id: f"{from_si(each.answer, each.unit):.5g}" for each in exercises(student)} | change


def slips(student: str) -> dict[str, str]:
    """Answers that the usual slips give."""
    by_id = {each.id: each for each in exercises(student)}
    tip, force = by_id["tip"], by_id["press"]
    return {
        "tip": f"{from_si(-tip.answer, 'mm'):.4f} mm".replace(".", ","),
        "share": f"{from_si(by_id['share'].slips[0].value, '%'):.2f} %",
        "press": f"{force.answer / 1000:.6f}",
        "regular": "1 2 3",
        "slot": f"{by_id['slot'].slips[0].value:.2f} N",
    }


if __name__ == "__main__":
    files = {
        "answers-1234567.toml": ("1234567", "Ada Müller", {}),
        "answers-2718281.toml": ("2718281", "Leo Čapek", slips("2718281")),
        "answers-3141592.toml": (
            "3141592",
            "Zoë O'Neil",
            {"laboratory": "", "soft_joint": "", "left_over": "", "slot": ""},
        ),
    }
    for name, (student, called, change) in files.items():
        text = answers_text(student, typed(student, change), called)
        (FOLDER / name).write_text(text, encoding="utf-8")
