"""The HTML around a report on a log: one file, without anything from elsewhere."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from troupe.report.charts import escaped

MOST_ROWS = 200
"""Rows of a table."""

STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 66rem; margin: 2rem auto; padding: 0 1rem;
  color: #26292e; background: #fff; }
h1 { font-size: 1.6rem; }
h2 { margin-top: 2.2rem; border-bottom: 1px solid #ddd; font-size: 1.2rem; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: .9rem; }
.wide { overflow-x: auto; }
th, td {
  padding: .2rem .7rem; border-bottom: 1px solid #eee; text-align: right; vertical-align: top;
}
th:first-child, td:first-child, .text { text-align: left; }
td.text { overflow-wrap: anywhere; }
thead th { border-bottom: 2px solid #bbb; }
figure { margin: 1rem 1rem 1rem 0; display: inline-block; vertical-align: top; max-width: 100%; }
figure svg, figure img { max-width: 100%; height: auto; }
figcaption { font-size: .9rem; color: #555; max-width: 40rem; }
code, pre { font: .85rem/1.4 ui-monospace, monospace; background: #f5f5f5; }
pre {
  padding: .4rem .7rem; margin: 0; overflow-x: auto; white-space: pre-wrap;
  overflow-wrap: anywhere;
}
@media print {
  @page { margin: 15mm; }
  body { max-width: none; margin: 0; padding: 0; font-size: 10pt; }
  figure, tr { break-inside: avoid; }
  h1, h2 { break-after: avoid; }
  thead { display: table-header-group; }
  .wide { overflow: visible; }
}
"""


def page(title: str, body: Iterable[str]) -> str:
    """The page."""
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escaped(title)}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n"
        f"<h1>{escaped(title)}</h1>\n"
        + "\n".join(part for part in body if part)
        + "\n</body>\n</html>\n"
    )


def figure(picture: str, caption: str) -> str:
    """A picture with its caption, which is HTML."""
    return f"<figure>{picture}<figcaption>{caption}</figcaption></figure>"


def table(
    header: Sequence[str], rows: Sequence[Sequence[str]], *, texts: Sequence[int] = ()
) -> str:
    """A table; `texts`: columns that are text. Only the first rows are in it."""

    def row(cells: Iterable[str], kind: str) -> str:
        found = []
        for column, cell in enumerate(cells):
            look = ' class="text"' if column in texts else ""
            found.append(f"<{kind}{look}>{preformatted(cell.splitlines() or [''])}</{kind}>")
        return f"<tr>{''.join(found)}</tr>"

    body = "\n".join(row(cells, "td") for cells in rows[:MOST_ROWS])
    left = len(rows) - MOST_ROWS
    more = f"<p>... and {left} more: <code>troupe log export</code> has them all.</p>" * (left > 0)
    return (
        f'<div class="wide"><table><thead>{row(header, "th")}</thead>\n<tbody>\n{body}\n'
        f"</tbody></table></div>{more}"
    )


def preformatted(lines: Iterable[str]) -> str:
    """Lines of text."""
    return "<br>".join(map(escaped, lines))
