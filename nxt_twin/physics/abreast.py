"""A kernel's run once more, for several parameter sets abreast: its source, rewritten statement by statement.

One run waits for its own results most of the time, since each step needs the last. Sets under the same effects and the
same schedule take the same steps, so each statement is done for all of them before the next. What differs between sets
lies in one array, a row of `LANES` numbers a quantity; loops over such a row compile to vector instructions.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Sequence
from typing import final

LANES = 8
"""Sets in a block: as many doubles as the widest registers hold (AVX-512). Narrower ones take two or four turns."""

MOST = 32
"""Sets abreast at most. Two blocks take half as long again as one, which mostly waits for its own results."""

FEWEST = 4
"""Sets that are worth it: a step of all lanes takes as long as three or four steps of one set."""

_GIVEN = "values"
_OF_JOBS = frozenset(
    ("gains", "reading_std", "log_scale", "restart", "restart_angle", "restart_speed", "restart_states")
)
_OUTPUTS = ("predicted", "weight", "cost")
_TRACE = "trace"

Statements = Sequence[ast.stmt]


def abreast(run: str) -> str:
    """The source of `run_abreast` from that of `run`, a function of one parameter set.

    Three arguments come first. `blocks` is how many times `LANES` sets there are. `row` tells for each lane where its
    set stands in `values` and in the outputs, and `of` where it stands in gains and starts. The other arguments are
    those of `run`, which may no longer trace.
    """
    function = next(node for node in ast.parse(run).body if isinstance(node, ast.FunctionDef))
    body = _Untraced().visit(function).body
    rewriting = _Rewriting(_differing(body))
    function.name = "run_abreast"
    arguments = [one for one in function.args.args if one.arg != _TRACE]
    function.args.args = [ast.arg("blocks"), ast.arg("row"), ast.arg("of"), *arguments]
    function.body = [*ast.parse(f"w = np.empty({rewriting.size})").body, *rewriting.rewritten(body)]
    return ast.unparse(ast.fix_missing_locations(function))


def _differing(body: Statements) -> list[str]:
    """The names whose values differ between sets: what follows from parameters and gains, or where these decide."""
    found = {_GIVEN, *_OF_JOBS, *_OUTPUTS}
    while True:
        new = {name for name in _assigned_differently(body, found, differs=False) if name not in found}
        if not new:
            return sorted(found - {_GIVEN, *_OF_JOBS})
        found |= new


def _assigned_differently(body: Statements, known: set[str], *, differs: bool) -> Iterator[str]:
    for statement in body:
        match statement:
            case ast.If():
                inside = differs or bool(_names(statement.test) & known)
                yield from _assigned_differently(statement.body, known, differs=inside)
                yield from _assigned_differently(statement.orelse, known, differs=inside)
            case ast.For():
                yield from _assigned_differently(statement.body, known, differs=differs)
            case ast.Assign() | ast.AugAssign() if differs or _names(statement.value) & known:
                yield from _targets(statement)


def _names(node: ast.AST) -> set[str]:
    return {part.id for part in ast.walk(node) if isinstance(part, ast.Name)}


def _targets(node: ast.AST) -> set[str]:
    """The names that a statement and those inside it assign, arrays of which they assign an element among them."""
    found: set[str] = set()
    for part in ast.walk(node):
        match part:
            case ast.Assign(targets=targets):
                found |= {name for target in targets for name in _assigned(target)}
            case ast.AugAssign(target=target):
                found |= set(_assigned(target))
    return found


def _assigned(target: ast.expr) -> Iterator[str]:
    match target:
        case ast.Name(id=name) | ast.Subscript(value=ast.Name(id=name)):
            yield name
        case ast.Tuple(elts=parts):
            for part in parts:
                yield from _assigned(part)


@final
class _Untraced(ast.NodeTransformer):
    """Takes out what is done for a trace."""

    def visit_If(self, node: ast.If) -> ast.If | None:
        """Nothing in the place of what only a trace needs."""
        if _TRACE in _names(node.test):
            return None
        self.generic_visit(node)
        return node


@final
class _Rewriting(ast.NodeTransformer):
    """Puts loops over lanes around statements, and an element of the array in the place of what differs there."""

    def __init__(self, differing: Iterable[str]) -> None:
        self._place = {name: MOST * number for number, name in enumerate(differing)}
        self.size = MOST * len(self._place)

    def rewritten(self, body: Statements) -> list[ast.stmt]:
        """The statements, those that differ between sets in loops over lanes."""
        found: list[ast.stmt] = []
        waiting: list[ast.stmt] = []
        for statement in body:
            alike = not self._differs(statement)
            if alike and not any(_targets(statement) & _names(one) for one in waiting):
                found.append(statement)  # which nothing that waits needs as it was
                continue
            shared = alike or self._is_shared(statement)
            if shared:
                found += self._looped(waiting)
                waiting = []
                found += self._recursed(statement)
            else:
                waiting.append(statement)
        return found + self._looped(waiting)

    def _differs(self, statement: ast.stmt) -> bool:
        return bool(_names(statement) & {_GIVEN, *_OF_JOBS, *self._place})

    def _is_shared(self, statement: ast.stmt) -> bool:
        """Whether all sets go through the statement's inside together, if at all."""
        return isinstance(statement, ast.For) or (
            isinstance(statement, ast.If) and not self._differs(ast.Expr(statement.test))
        )

    def _recursed(self, statement: ast.stmt) -> list[ast.stmt]:
        match statement:
            case ast.If(test=test, body=body, orelse=other):
                return [ast.If(test, self.rewritten(body) or [ast.Pass()], self.rewritten(other))]
            case ast.For(target=target, iter=over, body=body):
                handed_over = self._handed_over() if _assigns_outputs(body) else []
                return [ast.For(target, over, [*self.rewritten(body), *handed_over], [])]
        return [statement]

    def _looped(self, statements: Statements) -> list[ast.stmt]:
        if not statements:
            return []
        return [_over_lanes([self.visit(statement) for statement in statements])]

    def _handed_over(self) -> list[ast.stmt]:
        """A row's outputs, from the lanes to where they belong."""
        lines = [f"{name}[row[lane], k] = w[{self._place[name]} + lane]" for name in _OUTPUTS]
        return [_over_lanes(ast.parse("\n".join(lines)).body)]

    def visit_Name(self, node: ast.Name) -> ast.expr:
        """An element of the array in the place of a quantity that differs."""
        return self._element(node.id, node.ctx) if node.id in self._place else node

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        """An element of the array in the place of an output, and of a set's values that of its row."""
        match node.value:
            case ast.Name(id=name) if name in _OUTPUTS:
                return self._element(name, node.ctx)
            case ast.Name(id=name) if name == _GIVEN:
                return self._of_lane("row", node)
            case ast.Name(id=name) if name in _OF_JOBS:
                return self._of_lane("of", node)
        return ast.Subscript(self.visit(node.value), self.visit(node.slice), node.ctx)

    def _of_lane(self, which: str, node: ast.Subscript) -> ast.expr:
        """The element of an array whose first index is that of the lane's own row."""
        own = ast.parse(f"{which}[lane]", mode="eval").body
        inner = self.visit(node.slice)
        rest = inner.elts if isinstance(inner, ast.Tuple) else [inner]
        return ast.Subscript(node.value, ast.Tuple([own, *rest], ast.Load()), node.ctx)

    def _element(self, name: str, context: ast.expr_context) -> ast.expr:
        index = ast.BinOp(ast.Constant(self._place[name]), ast.Add(), ast.Name("lane", ast.Load()))
        return ast.Subscript(ast.Name("w", ast.Load()), index, context)


def _assigns_outputs(body: Statements) -> bool:
    """Whether a loop's own statements, not those of loops inside it, give the outputs."""
    return any(set(_OUTPUTS) & _targets(one) for one in body if not isinstance(one, ast.For))


def _over_lanes(body: list[ast.stmt]) -> ast.For:
    every = ast.parse(f"range(blocks * {LANES})", mode="eval").body
    return ast.For(ast.Name("lane", ast.Store()), every, body, [])
