"""The small change of sentences: signs with their plain spelling, numbers below the line, lists in words."""

from collections.abc import Callable, Iterable

MINUS = "−"
DASHES = "−–‐‑"  # what people and programs write for a minus, beside "-"
RAISED = dict(zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻ᵀ", "0123456789+-T", strict=True))
LOWERED = dict(zip("₀₁₂₃₄₅₆₇₈₉ₘ", "0123456789m", strict=True))
MICRO = {"µ": "u", "μ": "u"}
PLAIN = {
    **MICRO,
    **dict.fromkeys(f"{DASHES}—", "-"),
    **{"×": "x", "±": "+-", "·": "-", "⋅": "*"},
    **{"…": "...", "→": "->", "≤": "<=", "≥": ">=", "≈": "~", "≠": "!=", "∞": "inf", "√": "sqrt", "Ø": "dia. "},
    **{"α": "alpha", "β": "beta", "δ": "delta", "Δ": "Delta", "θ": "theta", "λ": "lambda", "σ": "sigma", "Σ": "Sigma"},
    **{"φ": "phi", "ω": "omega", "τ": "tau", "π": "pi", "′": "'", "″": '"', "‘": "'", "’": "'", "“": '"', "”": '"'},
    **{"‹": "<", "›": ">", "•": "*", "½": "1/2", "¼": "1/4", "¾": "3/4", "⁄": "/"},
    **{"\xa0": " ", "\u202f": " ", "\ufffd": "?"},
}
_BELOW = str.maketrans({digit: sign for sign, digit in LOWERED.items()})


def spelled(text: str, at: int, end: int, other: Callable[[str], str]) -> tuple[str, int]:
    """``text[at:end]`` in ASCII and where to go on: a raised or lowered number is spelled to its own end. ``other``
    spells a character that has no plain spelling."""
    said = []
    while at < end:
        for marks, sign in ((RAISED, "^"), (LOWERED, "_")):
            if text[at] in marks:
                said.append(sign)
                while at < len(text) and text[at] in marks:
                    said.append(marks[text[at]])
                    at += 1
                break
        else:
            if text[at] == "°":
                said.append(" deg" if text[at - 1 : at].isdigit() else "deg")
            else:
                said.append(PLAIN.get(text[at]) or (text[at] if text[at].isascii() else other(text[at])))
            at += 1
    return "".join(said), at


def signed(way: float, axis: str) -> str:
    """A direction along an axis: ``+X``, ``−Y``."""
    return f"{'+' if way > 0 else MINUS}{axis}"


def lowered(name: str, number: int) -> str:
    """A name with a number below the line: ``θ₁``."""
    return f"{name}{str(number).translate(_BELOW)}"


def listed(words: Iterable[str], last: str = "and") -> str:
    """In words: ``A``, ``A and B``, ``A, B and C``; "" where there are none."""
    *first, end = [*words] or [""]
    return f"{', '.join(first)} {last} {end}" if first else end
