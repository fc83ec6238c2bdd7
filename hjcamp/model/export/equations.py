r"""A composed model as LaTeX: its equations, line by line, its effects, and a table of its parameters with units."""

from __future__ import annotations

import ast
import re

from hjcamp.model.export.python_file import Exported
from hjcamp.model.language.vocabulary import read_vocabulary

BINDING = {ast.Add: 1, ast.Sub: 1, ast.Mult: 2, ast.Div: 2, ast.Pow: 4}
SIGNS = {ast.Add: "+", ast.Sub: "-", ast.Mult: r"\,"}
COMPARED = {ast.Lt: "<", ast.LtE: r"\le", ast.Gt: ">", ast.GtE: r"\ge", ast.Eq: "=", ast.NotEq: r"\ne"}
NAMED = {"sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "log", "min", "max"}
# Begins the name of a line that is called like a state or a parameter.
CHANGED = "changed__"
GREEK = {
    "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "kappa", "lambda", "mu", "nu", "xi", "pi", "rho", "sigma",
    "tau", "phi", "chi", "psi", "omega",
}  # fmt: skip


def latex_name(name: str) -> str:
    r"""Return a name as a symbol: ``s_`` and its like go, one letter stays, a Greek name is its letter, any other is upright."""
    plain = re.sub(r"^[spu]_(?=.)", "", name)
    if plain.startswith(CHANGED):
        return rf"\widehat{{{latex_name(plain.removeprefix(CHANGED))}}}"
    first, _, rest = plain.partition("_")
    if len(first) == 1 or first in GREEK:
        symbol = f"\\{first}" if first in GREEK else first
        return symbol + (rf"_{{\mathrm{{{_words(rest)}}}}}" if rest else "")
    return rf"\mathit{{{_words(plain)}}}"


def _words(text: str) -> str:
    return text.replace("_", r"\_")


def latex_formula(expression: str) -> str:
    """Return an expression of a plant's equations as LaTeX."""
    return _formula(ast.parse(expression, mode="eval").body)


def _formula(node: ast.expr) -> str:
    match node:
        case ast.Constant():
            return _number(node.value)
        case ast.Name():
            return latex_name(node.id)
        case ast.UnaryOp(op=ast.USub()):
            return f"-{_inside(node.operand, 2)}"
        case ast.UnaryOp(op=ast.Not()):
            return rf"\neg {_inside(node.operand, 5)}"
        case ast.BinOp(op=ast.Div()):
            return rf"\frac{{{_formula(node.left)}}}{{{_formula(node.right)}}}"
        case ast.BinOp(op=ast.Pow()):
            return f"{_inside(node.left, 5)}^{{{_formula(node.right)}}}"
        case ast.BinOp() if type(node.op) in SIGNS:
            own = BINDING[type(node.op)]
            right = _inside(node.right, own + isinstance(node.op, ast.Sub))
            return f"{_inside(node.left, own)} {SIGNS[type(node.op)]} {right}"
        case ast.Compare():
            parts = [_formula(node.left)]
            for sign, compared in zip(node.ops, node.comparators, strict=True):
                parts += [COMPARED[type(sign)], _formula(compared)]
            return " ".join(parts)
        case ast.BoolOp():
            between = r" \wedge " if isinstance(node.op, ast.And) else r" \vee "
            return between.join(_inside(one, 1) for one in node.values)
        case ast.IfExp():
            rest = rf"{_formula(node.orelse)} & \text{{else}}"
            return rf"\begin{{cases}} {_formula(node.body)} & {_formula(node.test)} \\ {rest} \end{{cases}}"
        case ast.Call(func=ast.Name()):
            return _call(node)
    return rf"\texttt{{{_words(ast.unparse(node))}}}"


def _inside(node: ast.expr, least: int) -> str:
    """Return a part of a formula, in brackets where it binds less than what it stands in."""
    binds = BINDING.get(type(node.op), 9) if isinstance(node, ast.BinOp) and not isinstance(node.op, ast.Div) else 9
    low = isinstance(node, ast.UnaryOp) or (isinstance(node, ast.BoolOp | ast.Compare | ast.IfExp) and least > 1)
    text = _formula(node)
    return rf"\left({text}\right)" if binds < least or low else text


def _call(node: ast.Call) -> str:
    assert isinstance(node.func, ast.Name)
    name, values = node.func.id, [_formula(one) for one in node.args]
    if name == "abs":
        return rf"\left|{values[0]}\right|"
    if name == "sqrt":
        return rf"\sqrt{{{values[0]}}}"
    if name == "limited":
        return rf"\operatorname{{sat}}_{{{values[1]}}}^{{{values[2]}}}\!\left({values[0]}\right)"
    head = rf"\{name}" if name in NAMED else rf"\operatorname{{{_words(name)}}}"
    return rf"{head}\left({', '.join(values)}\right)"


def _number(value: object) -> str:
    text = f"{value:.7g}" if isinstance(value, int | float) else str(value)
    mantissa, _, power = text.partition("e")
    if not power:
        return text
    factor = "" if mantissa in ("1", "-1") else rf"{mantissa} \cdot "
    return rf"{'-' if mantissa == '-1' else ''}{factor}10^{{{int(power)}}}"


def equations_of(exported: Exported) -> list[str]:
    r"""Return the lines of the plant as they are computed, ``target &= formula``.

    A rate has a dot; what is called like a state, a parameter or an input and is another quantity has a hat.
    """
    plant, found = exported.composition.plant, []
    lines = read_vocabulary(plant).statements
    twice = {line.target for line in lines if line.mark != "rate"} & {*plant.states, *plant.parameters, *plant.inputs}
    called = re.compile(rf"\b({'|'.join(map(re.escape, sorted(twice)))})\b") if twice else None
    for line in lines:
        expression = called.sub(rf"{CHANGED}\1", line.expression) if called else line.expression
        symbol = latex_name(line.target if line.mark == "rate" or line.target not in twice else CHANGED + line.target)
        target = rf"\dot{{{symbol}}}" if line.mark == "rate" else symbol
        found.append(f"{target} &= {latex_formula(expression)}")
    return found


def latex_file(exported: Exported) -> str:
    """Return a LaTeX document of its own: equations, effects, parameters with units, and where they come from."""
    made = exported.composition
    rows = [
        rf"$\mathit{{{_words(name)}}}$ & \num{{{value:.7g}}} & \si{{{_unit(made.parameters[name].unit)}}} \\"
        for name, value in exported.parameters.items()
        if abs(value) < float("inf")
    ]
    effects = [
        rf"\paragraph{{{_words(one.name)}}} acts on {', '.join(map(_words, one.terms))}."
        + (f"\n\\[ {one.equation()} \\]" if one.equation() else "")
        for one in made.effects
    ]
    late = [
        rf"Input {_words(name)} acts \SI{{{value:.4g}}}{{s}} later than it is given.\par"
        for name, value in exported.delays.items()
    ]
    lines = [
        rf"% {exported.title}; from {' '.join(str(dict(exported.source)).split())}",
        r"\documentclass{article}",
        r"\usepackage[margin=20mm]{geometry}",
        r"\usepackage{amsmath,booktabs,longtable,siunitx}",
        r"\allowdisplaybreaks",
        r"\begin{document}",
        rf"\section*{{{_words(exported.title)}}}",
        r"\begin{align*}",
        " \\\\\n".join(equations_of(exported)),
        r"\end{align*}",
        *effects,
        *late,
        r"\begin{longtable}{lll}",
        r"\toprule parameter & value & unit \\ \midrule",
        *rows,
        r"\bottomrule",
        r"\end{longtable}",
        r"\end{document}",
    ]
    return "\n".join(lines) + "\n"


def _unit(unit: str) -> str:
    return "" if unit == "1" else unit.replace("*", ".").replace(" ", ".")
