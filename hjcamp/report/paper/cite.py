"""The sources that docstrings name, as BibTeX."""

from __future__ import annotations

import inspect
import re
import unicodedata
from collections.abc import Iterable

THESIS = """@misc{thesis,
  key = {thesis},
  title = {{Design and Control of a Closed-Circuit Servo-Controlled Miniature Hydraulic Rotary Joint}},
  howpublished = {Thesis},
  note = {author, university and year are to be completed},
}
"""
NAME = r"(?:(?:[Dd]e|[Dd]en|[Vv]an|[Vv]on|Canudas de) )?[A-Z][\w'’-]+"
CITED = re.compile(rf"({NAME}(?:(?:, | & ){NAME})*(?: et al\.)?) \((\d{{4}})\)")
SOURCE = re.compile(r"\bSources?: (.+?)(?:\n\s*\n|\Z)", re.DOTALL)
DOI = re.compile(r"doi:(\S+?)[.,;)]*(?:\s|$)")
ARTICLE = re.compile(
    r"(?:(?P<title>.+?), )??(?P<journal>[A-Z][^,]*?(?:, [A-Z][^,]*?, and [A-Z][^,]*?)?) "
    r"(?P<volume>[A-Z]? ?\d+)(?:\((?P<number>[^)]+)\))?, (?P<pages>\d+(?:-\d+)?)"
)
REMARK = re.compile(r" \([^)]*\)?")  # a volume's number follows without a space
BOOK = re.compile(
    r"(?P<title>[A-Z].+?)(?:, (?P<edition>\d+(?:st|nd|rd|th)) ed\.)?(?:, (?P<part>(?:chapter|section|sections|chapters) [^;]+))?"
)


def sources_of(documented: object) -> str:
    """Return the text behind ``Source:`` in a docstring on one line; empty where there is none."""
    found = SOURCE.search(inspect.cleandoc(getattr(documented, "__doc__", None) or ""))
    return " ".join(found[1].split()) if found else ""


def entries_of(source: str) -> dict[str, str]:
    """Return key -> BibTeX entry of each work that a source names as ``Authors (year), ...``."""
    found = list(CITED.finditer(source))
    entries: dict[str, str] = {}
    for place, one in enumerate(found):
        end = found[place + 1].start() if place + 1 < len(found) else len(source)
        rest = REMARK.sub("", source[one.end() : end].split(";")[0]).strip(" ,.)")
        key, entry = _entry(one[1], one[2], rest)
        entries.setdefault(key, entry)
    return entries


def bibliography(documented: Iterable[object], with_thesis: bool) -> dict[str, str]:
    """Return key -> entry of all that the docstrings cite, by key; the reference itself where ``with_thesis``."""
    entries = {"thesis": THESIS} if with_thesis else {}
    for one in documented:
        for key, entry in entries_of(sources_of(one)).items():
            # Two mentions of one work may name different parts of it: the fuller one stays.
            entries[key] = max(entries.get(key, ""), entry, key=len)
    return dict(sorted(entries.items()))


def _entry(authors: str, year: str, rest: str) -> tuple[str, str]:
    names = re.split(r", | & ", authors.removesuffix(" et al."))
    names += ["others"] if authors.endswith("et al.") else []
    key = f"{_letters(names[0])}{year}"
    fields = {"author": " and ".join(f"{{{name}}}" if " " in name else name for name in names), "year": year}
    doi = DOI.search(f"{rest} ")
    rest = DOI.sub("", f"{rest} ").strip(" ,.") if doi else rest
    article, book = ARTICLE.fullmatch(rest), BOOK.fullmatch(rest)
    if article:
        kind = "article"
        fields |= {name: value for name, value in article.groupdict().items() if value}
        fields["pages"] = fields["pages"].replace("-", "--")
    elif book and book["title"]:
        kind = "book" if book["part"] or book["edition"] else "misc"
        fields["title"] = book["title"]
        fields |= {name: value for name, value in (("edition", book["edition"]), ("note", book["part"])) if value}
    else:
        kind = "misc"
        fields |= {"note": rest} if rest else {}
    fields |= {"doi": doi[1]} if doi else {}
    lines = [f"  {name} = {{{_latex(name, value)}}},\n" for name, value in fields.items()]
    return key, f"@{kind}{{{key},\n{''.join(lines)}}}\n"


def _latex(name: str, value: str) -> str:
    if name == "title":
        return f"{{{value}}}".replace("&", r"\&")
    return value if name in ("author", "doi") else value.replace("&", r"\&").replace("%", r"\%").replace("_", r"\_")


def _letters(name: str) -> str:
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    return re.sub(r"[^A-Za-z]", "", plain).lower()
