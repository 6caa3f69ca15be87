"""Markdown sections that are rewritten in place, and SVG plots that are the same bytes each time."""

import os
import textwrap
from dataclasses import dataclass
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot, ticker  # noqa: E402  (the backend comes first)

PLAIN = ticker.FuncFormatter(lambda value, position: f"{value:,g}")


@dataclass
class Section:
    """What an experiment found."""

    name: str  # of the experiment: names its markers and its plot
    title: str
    text: str  # Markdown below the title


def markdown_table(header: list[str], rows: list[list[str]]) -> str:
    """
    >>> print(markdown_table(["a", "b"], [["1", "2"]]))
    | a | b |
    |---|---|
    | 1 | 2 |
    """
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines)


def wrapped(text: str, width: int = 120) -> str:
    """Paragraphs filled to `width`; tables and pictures as they are.

    >>> wrapped("a b c\\n\\n| d | e f |", 3)
    'a b\\nc\\n\\n| d | e f |'
    """
    def filled(part: str) -> str:
        if part.startswith(("|", "!")):
            return part
        return textwrap.fill(part, width, break_long_words=False, break_on_hyphens=False)  # `depthfarm-experiments`

    return "\n\n".join(filled(part) for part in text.split("\n\n"))


def put_section(document: str, section: Section) -> str:
    """`document` with the section in the place of the one of its name, or at the end.

    >>> a = put_section("# T\\n", Section("x", "X", "one"))
    >>> put_section(a, Section("x", "X", "two")) == a.replace("one", "two")
    True
    """
    begin, end = f"<!-- experiment {section.name} -->", f"<!-- end {section.name} -->"
    block = f"{begin}\n## {section.title}\n\n{wrapped(section.text.rstrip())}\n{end}\n"
    if begin in document:
        before, rest = document.split(begin, 1)
        after = rest.split(end + "\n", 1)[1]
        return before + block + after
    return document.rstrip("\n") + "\n\n" + block


def write_section(path: Path, section: Section, heading: str) -> None:
    """Puts the section into a file, which begins with `heading` if it is new; written aside, then renamed."""
    document = path.read_text() if path.exists() else heading
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_suffix(".part")
    temporary.write_text(put_section(document, section))
    os.replace(temporary, path)


@dataclass
class Curve:
    """One line of a plot."""

    name: str
    x: list[float]
    y: list[float]
    dashed: bool = False  # the paper's
    markers: bool = True


def flat(name: str, x: list[float], y: float) -> Curve:
    """What does not depend on x."""
    return Curve(name, [min(x), max(x)], [y, y], markers=False)


def write_plot(path: Path, curves: list[Curve], x_label: str, y_label: str, log_x: bool = False) -> None:
    """Lines over x; the same bytes for the same curves, for neither date nor random ids are written."""
    matplotlib.rcParams["svg.hashsalt"] = "depthfarm"
    figure, axes = pyplot.subplots(figsize=(6, 3.6))
    for curve in curves:
        style = ("--" if curve.dashed else "-") + ("o" if curve.markers else "")
        axes.plot(curve.x, curve.y, style, label=curve.name, markersize=4)
    if log_x:
        axes.set_xscale("log")
        axes.xaxis.set_minor_locator(ticker.LogLocator(subs=(2, 5)))
        axes.xaxis.set_major_formatter(PLAIN)
        axes.xaxis.set_minor_formatter(PLAIN)
    else:
        axes.set_xticks(sorted({x for curve in curves for x in curve.x}))
    axes.set_xlabel(x_label)
    axes.set_ylabel(y_label)
    axes.grid(alpha=0.3)
    # Above the axes: inside it hides points, or looks as if it had one more.
    axes.legend(frameon=False, fontsize=8, loc="lower center", bbox_to_anchor=(0.5, 1), ncol=2)
    figure.tight_layout()
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, format="svg", metadata={"Date": None, "Creator": None})
    pyplot.close(figure)
