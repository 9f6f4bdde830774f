"""Style sheets of an SVG page, written into the elements that they hold for: the cascade of CSS 2.1, 6.4.

Read by tinycss2 and matched by cssselect2; svgelements, which draws, knows a class, an id or a name alone.
"""

import re
from collections.abc import Callable, Iterable, Iterator
from typing import Any
from xml.etree import ElementTree

from robomill.extras import needed
from robomill.units import format_count

# All that says where a line is; the rest would be handed down to every element below.
PLACES = "d points x y x1 y1 x2 y2 cx cy r rx ry width height viewBox preserveAspectRatio transform"
STYLED = frozenset((*PLACES.split(), "display", "visibility", "clip-path", "clip-rule", "mask"))
MOST_SHEET = 200_000  # characters of all sheets, without comments and what they embed
MOST_STYLE = 20_000_000  # characters of them, times elements
MOST_LOOKS = 20_000_000  # at what is around and beside all elements
SHOWN = {"", "all", "screen"}  # media of a page that is looked at
INHERITED = ("inherit", "unset")  # as if nothing was said
Declared = tuple[tuple[str, str, bool], ...]
"""Name, value and whether it is important."""
_BESIDE = re.compile(r"/\*.*?(?:\*/|$)|url\(\s*['\"]?data:[^)]*\)", re.DOTALL)
_SAYS = re.compile(rf"(?<![\w-])(?:{'|'.join(sorted(STYLED))})\s*:", re.IGNORECASE)
_PART = re.compile(r"""(?:[^;"'(]+|"[^"]*"?|'[^']*'?|\([^)]*\)?)+""")
_IMPORTANT = re.compile(r"!\s*important\s*$", re.IGNORECASE)
Refuse = Callable[[str], Exception]


def write_in(root: ElementTree.Element, depth: int, refuse: Refuse) -> None:
    """Write into the style of every element what the sheets of the page and its own style say of where it is and
    whether it is drawn, of each the one that holds. ``depth`` is how many elements stand one in another.

    Raises
    ------
    Exception
        What ``refuse`` makes of too much.
    """
    with needed("An SVG drawing"):
        from cssselect2 import ElementWrapper, Matcher

    matcher, rules = Matcher(), list(_rules(root, depth, refuse))
    if not rules:
        for element in root.iter():
            _write(element, ())
        return
    for selector, said in rules:
        matcher.add_selector(selector, said)
    for wrapped in ElementWrapper.from_xml_root(root).iter_subtree():
        _write(wrapped.etree_element, [each for *_, said in matcher.match(wrapped) for each in said])


def held(element: ElementTree.Element, name: str) -> str:
    """What holds for an element once ``write_in`` has been there: of its style, else of its attributes; "" for none."""
    style = dict(part.partition(":")[::2] for part in element.get("style", "").split(";"))
    return str(style.get(name, element.get(name, ""))).strip()


def _write(element: ElementTree.Element, sheets: Iterable[tuple[str, str, bool]]) -> None:
    own = element.attrib.pop("style", "")
    said = (*sheets, *(_own(own) if _SAYS.search(own) else ()))
    holds = {name: value for important in (False, True) for name, value, so in said if so is important}
    for name in [name for name, value in holds.items() if value in INHERITED]:
        del holds[name]
        element.attrib.pop(name, None)
    if holds:
        element.set("style", ";".join(f"{name}:{value}" for name, value in holds.items()))


def _rules(root: ElementTree.Element, depth: int, refuse: Refuse) -> Iterator[tuple[Any, Declared]]:
    """Selectors of all sheets in their order, with what they say."""
    from cssselect2 import SelectorError, compile_selector_list
    from tinycss2 import parse_stylesheet, serialize

    elements = list(root.iter())
    beside, looks = max(map(len, elements)), 0
    written = (_BESIDE.sub(" ", e.text or "") for e in elements if str(e.tag).rpartition("}")[2] == "style")
    sheets = [sheet for sheet in written if _SAYS.search(sheet)]
    length = sum(map(len, sheets))
    if length > MOST_SHEET or length * len(elements) > MOST_STYLE:
        raise refuse(f"its styles are {format_count(length)} characters long")
    for rule in _shown([rule for sheet in sheets for rule in parse_stylesheet(sheet)]):
        said = _declared(rule.content)
        if not said:
            continue
        names = serialize(rule.prelude)
        looks += sum(len(elements) * _around(name, depth, beside) for name in names.split(","))
        if looks > MOST_LOOKS:
            raise refuse("its styles pick elements by what is around or beside others around them, too often")
        try:
            selectors = compile_selector_list(rule.prelude)
        except SelectorError:  # what is not understood does nothing, as in a browser
            continue
        yield from ((selector, said) for selector in selectors if selector.pseudo_element is None)


def _around(selector: str, depth: int, beside: int) -> int:
    """How many elements are looked at for one, at most: what is around it, and for each of those what is around it."""
    names = re.sub(r"\s*([>+~])\s*", r"\1", selector.strip())
    return int(depth ** len(names.split()[1:]) * beside ** names.count("~"))


def _shown(rules: Iterable[Any]) -> Iterator[Any]:
    """The rules that pick elements, those of a screen among them."""
    from tinycss2 import parse_rule_list, serialize

    for rule in rules:
        if rule.type == "qualified-rule":
            yield rule
        elif rule.type == "at-rule" and rule.lower_at_keyword == "media":
            media = {each.strip().lower() for each in serialize(rule.prelude).split(",")}
            inside = parse_rule_list(rule.content or "") if media & SHOWN else ()
            yield from (each for each in inside if each.type == "qualified-rule")


def _own(style: str) -> Iterator[tuple[str, str, bool]]:
    """As ``_declared``, of the style of an element, of which there may be very many."""
    for part in _PART.findall(_BESIDE.sub(" ", style)):
        name, _, value = part.partition(":")
        if (name := name.strip().lower()) in STYLED:
            plain = _IMPORTANT.sub("", value)
            yield name, _word(plain), plain != value


def _declared(style: Any) -> Declared:
    """What the tokens of a rule say of where a line is, and whether it is drawn."""
    from tinycss2 import parse_blocks_contents, serialize

    return tuple(
        (each.lower_name, _word(serialize(each.value)), bool(each.important))
        for each in parse_blocks_contents(style)
        if each.type == "declaration" and each.lower_name in STYLED
    )


def _word(value: str) -> str:
    """A value as it is written, a word of CSS in small letters."""
    text = value.strip()
    return text.lower() if text.isalpha() else text
