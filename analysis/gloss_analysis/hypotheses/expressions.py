"""Hypotheses that a user types: `name=expression` over the columns of the stimuli, read without running any code.

An expression is arithmetic on column names, numbers and a few functions. It is parsed, and every part of it is looked
at: whatever is not on the list is refused, so that a file of hypotheses from elsewhere can do nothing but arithmetic.
"""

import ast
import operator
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd

from gloss_analysis.hypotheses.candidates import Axis, Hypothesis
from glossspace.errors import GlossError

__all__ = ["FUNCTIONS", "hypothesis_from"]

FUNCTIONS: dict[str, tuple[Callable[..., Any], int]] = {
    "cbrt": (np.cbrt, 1),
    "sqrt": (np.sqrt, 1),
    "log": (np.log, 1),
    "log10": (np.log10, 1),
    "exp": (np.exp, 1),
    "abs": (np.abs, 1),
    "minimum": (np.minimum, 2),
    "maximum": (np.maximum, 2),
}
"""What an expression may call, and with how many arguments; logarithms are natural unless they say 10."""

_BINARY: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}
_UNARY: dict[type[ast.unaryop], Callable[[Any], Any]] = {ast.USub: operator.neg, ast.UAdd: operator.pos}
# A formula that a person reads fits in this, and its depth in the stack of whoever walks through it.
_LONGEST = 300


def hypothesis_from(text: str, axis: Axis) -> Hypothesis:
    """Read a hypothesis from `name=expression`.

    Parameters
    ----------
    text : str
        A name, an equals sign, and an expression of + - * / ** and brackets over columns of the stimuli, numbers and
        `FUNCTIONS`.
    axis : {"c", "d"}
        The axis that it is meant to be.

    Returns
    -------
    Hypothesis

    Raises
    ------
    GlossError
        There is no name or no expression, it cannot be read, or it has a part that is not allowed. A column that the
        stimuli lack is refused when values are asked for.

    Examples
    --------
    >>> stimuli = pd.DataFrame({"stimulus": ["a", "b"], "rho_d": [0.0, 0.054], "rho_s": [0.064, 0.1]})
    >>> found = hypothesis_from("no halves = cbrt(rho_s + rho_d) - cbrt(rho_d)", "c")
    >>> found.name, found.values(stimuli).round(4).tolist()
    ('no halves', [0.4, 0.158])
    """
    name, equals, expression = (part.strip() for part in text.partition("="))
    if not (name and equals and expression):
        raise GlossError(
            f"Invalid function {text!r}. Allowed: a name, an equals sign and an expression, such as "
            "'energy=rho_s' or 'no halves=cbrt(rho_s + rho_d) - cbrt(rho_d)'."
        )
    if len(expression) > _LONGEST:
        raise GlossError(
            f"The function {name!r} is longer than {_LONGEST} characters. Add it to the table as a column."
        )
    try:
        # The parser warns of such things as 1(2), which are refused below.
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree = ast.parse(expression, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise GlossError(
            f"The function {name!r} cannot be read: {expression!r}. Allowed: arithmetic on columns of the stimuli, "
            "such as cbrt(rho_s + rho_d / 2) - cbrt(rho_d / 2). A column whose name is more than letters, digits and "
            "underscores must be renamed."
        ) from None
    _check(tree, name)
    return Hypothesis(name, axis, lambda stimuli: np.broadcast_to(_value(tree, stimuli), (len(stimuli),)))


def _check(node: ast.AST, name: str) -> None:
    match node:
        case ast.Name():
            if node.id in FUNCTIONS:
                raise GlossError(f"The function {name!r} names {node.id} without brackets. Write {node.id}(...).")
        case ast.Constant():
            if isinstance(node.value, bool) or not isinstance(node.value, int | float):
                raise GlossError(f"The function {name!r} has {node.value!r}, which is no number.")
        case ast.UnaryOp() if type(node.op) in _UNARY:
            _check(node.operand, name)
        case ast.BinOp() if type(node.op) in _BINARY:
            _check(node.left, name)
            _check(node.right, name)
        case ast.Call(func=ast.Name(id=called), keywords=[]) if called in FUNCTIONS:
            wanted = FUNCTIONS[called][1]
            if len(node.args) != wanted:
                raise GlossError(
                    f"The function {name!r} calls {called} with {len(node.args)} arguments; it takes {wanted}."
                )
            for one in node.args:
                _check(one, name)
        case _:
            raise GlossError(
                f"The function {name!r} has {ast.unparse(node)!r}, which is not allowed. Allowed: columns, numbers, "
                f"+ - * / ** and brackets, and {', '.join(FUNCTIONS)}."
            )


def _value(node: ast.AST, stimuli: pd.DataFrame) -> Any:
    match node:
        case ast.Name():
            return pd.to_numeric(stimuli[node.id], errors="coerce").to_numpy(dtype=float)
        case ast.Constant():
            return np.float64(node.value)  # type: ignore[arg-type]
        case ast.UnaryOp():
            return _UNARY[type(node.op)](_value(node.operand, stimuli))
        case ast.BinOp():
            return _BINARY[type(node.op)](_value(node.left, stimuli), _value(node.right, stimuli))
        case ast.Call(func=ast.Name(id=called)):
            return FUNCTIONS[called][0](*(_value(one, stimuli) for one in node.args))
    raise AssertionError(f"{node} was checked")
