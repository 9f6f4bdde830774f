"""Random programs with O words, each with the places that it goes to as Python finds them on the way it is written."""

from __future__ import annotations

import random
from collections.abc import Callable
from typing import Any

Action = Callable[[dict[str, Any]], None]


class _Out(Exception):
    """Break, continue and return, and what is returned."""

    def __init__(self, kind: str, value: float = 0.0) -> None:
        self.kind, self.value = kind, value


class Writer:
    """Writes a program: ``lines``, and ``expected()`` places along X.

    ``wild`` programs break and continue out of everything, so that LinuxCNC's flags outlive their loops: nothing is
    expected of them here.
    """

    def __init__(self, seed: int, wild: bool = False) -> None:
        self.r, self.wild = random.Random(seed), wild
        self.lines: list[str] = ["G21 G90 F600"]
        self.label = 100
        self.subs: list[Action] = []
        for k in range(3):
            self.lines.append(f"O{k + 1} sub")
            names = "#<a>=#1 #<b>=#2 #<c>=0"
            self.lines.append(names)
            if k == 0:  # calls itself
                self.lines += ["O9 if [#1 GT 1]", "O1 call [#1-1] [#2+1]", "O9 endif"]
            body = self.block(2, k + 1, False)
            text, value = self.value()
            self.lines.append(f"O{k + 1} endsub [{text}]")
            self.subs.append(self.sub(k, body, value))
        self.lines += ["O4 sub", "O4 endsub [0]", "O4 call", "#<a>=1 #<b>=2 #<c>=0"]
        self.body = self.block(3, 0, False)
        self.lines.append("M2")

    def text(self) -> str:
        return "\n".join(self.lines) + "\n"

    def expected(self) -> list[float]:
        env: dict[str, Any] = {"moves": [], "names": {"a": 1.0, "b": 2.0, "c": 0.0}, "value": 0.0}
        env["numbers"] = dict.fromkeys([*range(1, 4), *range(31, 35)], 0.0)
        self.body(env)
        return env["moves"]

    def sub(self, k: int, body: Action, value: Callable[[dict[str, Any]], float]) -> Action:
        def run(env: dict[str, Any]) -> None:
            numbers = env["numbers"]
            env["names"] = {"a": numbers[1], "b": numbers[2], "c": 0.0}
            try:
                if k == 0 and numbers[1] > 1.0:
                    self.call_of(0, lambda e: e["numbers"][1] - 1.0, lambda e: e["numbers"][2] + 1.0)(env)
                body(env)
                env["value"] = value(env)
            except _Out as out:
                env["value"] = out.value

        return run

    def call_of(self, k: int, *arguments: Callable[[dict[str, Any]], float]) -> Action:
        def run(env: dict[str, Any]) -> None:
            aside, names = {i: env["numbers"][i] for i in (1, 2, 3)}, env["names"]
            given = [argument(env) for argument in arguments]
            env["numbers"] |= {1: given[0], 2: given[1], 3: 0.0}
            self.subs[k](env)
            env["numbers"] |= aside
            env["names"] = names

        return run

    # --- values
    def value(self, depth: int = 2) -> tuple[str, Callable[[dict[str, Any]], float]]:
        """A whole number from 0 to 6."""
        r = self.r
        kind = r.randrange(6 if depth else 4)
        if kind == 0:
            number = float(r.randint(0, 6))
            return f"{number:g}", lambda env: number
        if kind == 1:
            index = r.choice((1, 2, 3, 31, 32, 33, 34))
            return f"[#{index} MOD 7]", lambda env: env["numbers"][index] % 7.0
        if kind == 2:
            name = r.choice("abc")
            return f"[#<{name}> MOD 7]", lambda env: env["names"][name] % 7.0
        if kind == 3:
            return "[#<_value> MOD 7]", lambda env: env["value"] % 7.0
        (one, f), (two, g) = self.value(depth - 1), self.value(depth - 1)
        if kind == 4:
            return f"[[{one}*{two} + {one}] MOD 7]", lambda env: (f(env) * g(env) + f(env)) % 7.0
        return f"[{one} GT {two}]", lambda env: float(f(env) > g(env))

    # --- statements
    def block(self, depth: int, sub: int, breaks: bool) -> Action:
        """Some statements; in subroutine ``sub`` (0: none), ``breaks``: in a loop that may be left."""
        kinds = ["move", "set", "set"] + ["if", "while", "repeat", "call", "do"] * (depth > 0)
        actions = [self.statement(self.r.choice(kinds), depth, sub, breaks) for _ in range(self.r.randint(1, 4))]

        def run(env: dict[str, Any]) -> None:
            for action in actions:
                action(env)

        return run

    def statement(self, kind: str, depth: int, sub: int, breaks: bool) -> Action:
        if kind in ("if", "while", "repeat", "do"):
            self.label += 1
            return getattr(self, f"_{kind}")(f"O{self.label}", depth, sub, breaks)
        text, value = self.value()
        blank = self.r.choice(["", " ", "(so) "])
        if kind == "move":
            self.lines.append(f"{blank}G{self.r.randint(0, 1)} X{text if text[0] == '[' else f'[{text}]'}")
            return lambda env: env["moves"].append(value(env))
        if kind == "call" and sub < 3:
            k = self.r.randint(sub, 2)
            other, second = self.value()
            first = (lambda env: value(env) % 3.0) if k == 0 else value
            shown = f"[[{text}] MOD 3]" if k == 0 else f"[{text}]"
            self.lines.append(f"o {k + 1} CALL {shown} [{other}]{self.r.choice(['', ' (so)', ';so'])}")
            return self.call_of(k, first, second)
        index = self.r.choice((1, 2, 3, 31, 32, 33, 34))
        name = self.r.choice("abc")
        if self.r.random() < 0.5:
            self.lines.append(f"{blank}#{index}={text}")
            return lambda env: env["numbers"].update({index: value(env)})
        self.lines.append(f"#<{name}> = {text}")
        return lambda env: env["names"].update({name: value(env)})

    def _if(self, label: str, depth: int, sub: int, breaks: bool) -> Action:
        branches: list[tuple[Callable[[dict[str, Any]], float], Action]] = []
        for k in range(self.r.randint(1, 3)):
            text, value = self.value()
            self.lines.append(f"{label} {'elseif' if k else 'if'} [{text}]")
            branches.append((value, self._last(depth - 1, sub, breaks)))
        if self.r.random() < 0.5:
            self.lines.append(f"{label} else")
            branches.append((lambda env: 1.0, self._last(depth - 1, sub, breaks)))
        self.lines.append(f"{label} endif")

        def run(env: dict[str, Any]) -> None:
            for value, action in branches:
                if value(env):
                    action(env)
                    return

        return run

    def _last(self, depth: int, sub: int, breaks: bool) -> Action:
        """A block of a branch, which may end with a way out."""
        loops = self.loops if self.wild or breaks else []
        block = self.block(depth, sub, breaks)
        chance = self.r.random()
        if loops and chance < 0.4:
            kind = self.r.choice(("break", "continue"))
            self.lines.append(f"{self.r.choice(loops) if self.wild else loops[-1]} {kind}")
            return _then(block, lambda env: _Out(kind))
        if sub and chance < 0.6:
            text, value = self.value()
            self.lines.append(f"O{sub} return [{text}]")
            return _then(block, lambda env: _Out("return", value(env)))
        return block

    def _while(self, label: str, depth: int, sub: int, breaks: bool) -> Action:
        times, counter = self.r.randint(0, 3), f"#<w{label[1:]}>"
        self.lines += [f"{counter}=0", f"{label} while [{counter} LT {times}]", f"{counter}=[{counter}+1]"]
        self.loops.append(label)
        body = self.block(depth - 1, sub, True)
        self.loops.pop()
        self.lines.append(f"{label} endwhile")

        def run(env: dict[str, Any]) -> None:
            for _ in range(times):
                try:
                    body(env)
                except _Out as out:
                    if out.kind == "return":
                        raise
                    if out.kind == "break":
                        return

        return run

    def _do(self, label: str, depth: int, sub: int, breaks: bool) -> Action:
        if not self.wild:  # a flag that a break has left would be remembered here
            return self._repeat(label, depth, sub, breaks)
        counter = f"#<w{label[1:]}>"
        self.lines += [f"{counter}=0", f"{label} do", f"{counter}=[{counter}+1]"]
        self.loops.append(label)
        body = self.block(depth - 1, sub, True)
        self.loops.pop()
        self.lines.append(f"{label} while [{counter} LT {self.r.randint(0, 3)}]")
        return body

    def _repeat(self, label: str, depth: int, sub: int, breaks: bool) -> Action:
        text, value = self.value()
        self.lines.append(f"{label} repeat [[{text}] MOD 4]")
        body = self.block(depth - 1, sub, False)  # out of a repeat its count is kept
        self.lines.append(f"{label} endrepeat")

        def run(env: dict[str, Any]) -> None:
            for _ in range(int(value(env) % 4.0)):
                body(env)

        return run

    @property
    def loops(self) -> list[str]:
        return self.__dict__.setdefault("_loops", [])


def _then(block: Action, out: Callable[[dict[str, Any]], _Out]) -> Action:
    def run(env: dict[str, Any]) -> None:
        block(env)
        raise out(env)

    return run
