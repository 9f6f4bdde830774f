"""A student's own numbers: drawn from a student number by SHA-256, the same on every machine and in every version.

The k-th draw is the SHA-256 of ``robomill exercises 1|<words>|k``, read as a number in [0, 1) by its first 53 bits. No
generator of a library is used, whose streams may change from one version to the next.
"""

import hashlib
import re
import unicodedata
from collections.abc import Sequence
from typing import TypeVar

from robomill.errors import LearnError

PROTOCOL = "robomill exercises 1"
LONGEST = 32  # characters of a student number
T = TypeVar("T")


def student_number(given: str | int) -> str:
    """A student number as it is drawn from: without blanks and leading zeros, which tables drop; in small letters.

    Raises LearnError for what is none: up to 32 letters, digits, dots, hyphens and underscores.
    """
    text = unicodedata.normalize("NFKC", str(given))
    plain = re.sub(r"[\s\u200b\ufeff]+", "", text).lower()
    if not plain or len(plain) > LONGEST or not re.fullmatch(r"[a-z0-9._-]+", plain):
        raise LearnError(
            f"Student number: found {text!r:.50}, expected up to {LONGEST} letters and digits, such as 1234567."
        )
    return plain.lstrip("0") or "0"


class Draws:
    """Numbers drawn one after another from the same words."""

    def __init__(self, *words: str) -> None:
        self.words = "|".join((PROTOCOL, *words))
        self.count = 0

    def unit(self) -> float:
        """In [0, 1)."""
        digest = hashlib.sha256(f"{self.words}|{self.count}".encode()).digest()
        self.count += 1
        return (int.from_bytes(digest[:8], "big") >> 11) / 2**53

    def whole(self, low: int, high: int) -> int:
        """From low to high, both of them too."""
        return low + int(self.unit() * (high - low + 1))

    def one_of(self, many: Sequence[T]) -> T:
        """One of many."""
        return many[self.whole(0, len(many) - 1)]

    def normal(self) -> float:
        """Of mean 0 and standard deviation 1: the sum of twelve draws less 6, by sums alone."""
        return sum(self.unit() for _ in range(12)) - 6.0
