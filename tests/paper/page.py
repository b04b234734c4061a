"""The pieces of the page: tables, pictures with captions, and the whole of it."""
import html

STYLE = """
body { font: 15px/1.5 sans-serif; color: #262c38; max-width: 1240px; margin: 2em auto; padding: 0 1em; }
h2 { margin-top: 2.2em; border-bottom: 1px solid #d9dce0; }
table { border-collapse: collapse; margin: 1em 0; }
th, td { padding: .25em .7em; text-align: right; border-bottom: 1px solid #e6e8eb; vertical-align: top; }
th { color: #787e88; font-weight: normal; } th.left, td.left { text-align: left; }
td.failed { color: #b02a37; text-align: left; } td.better { font-weight: bold; } .grey { color: #787e88; }
.pictures td { text-align: center; border: 0; padding: .3em; } .pictures img { max-width: 100%; display: block; }
"""


class Failed(str):
    """The last cell of a row that has no numbers to show, and why."""


def escaped(words):
    return html.escape(str(words))


def cell(content, kind=""):
    """Content is a text, escaped, or a pair (text, kind)."""
    if isinstance(content, tuple):
        content, kind = content
    return f'<td{f" class={kind!r}" if kind else ""}>{escaped(content)}</td>'


def table(head, rows, left=1):
    """The first columns to the left, numbers to the right. A row may end early, in a Failed."""
    lines = ["<table>", "<tr>" + "".join(f"<th{' class=left' if i < left else ''}>{escaped(h)}</th>" for i, h in enumerate(head)) + "</tr>"]
    for row in rows:
        cells, why = (row[:-1], row[-1]) if isinstance(row[-1], Failed) else (row, None)
        line = "".join(cell(c, "left" if i < left else "") for i, c in enumerate(cells))
        if why is not None:
            line += f'<td class="failed" colspan="{len(head) - len(cells)}">{escaped(why)}</td>'
        lines.append(f"<tr>{line}</tr>")
    return "\n".join([*lines, "</table>"])


def pictures(rows):
    """A grid of (file or None, caption)."""
    lines = ['<table class="pictures">']
    for row in rows:
        lines.append("<tr>" + "".join(picture(file, caption) for file, caption in row) + "</tr>")
    return "\n".join([*lines, "</table>"])


def picture(file, caption):
    seen = f'<a href="{escaped(file)}"><img src="{escaped(file)}" alt="{escaped(caption)}"></a>' if file else '<span class="grey">no picture</span>'
    return f"<td>{seen}{escaped(caption)}</td>"


def paragraph(words):
    return f"<p>{escaped(words)}</p>"


def image(file, caption):
    return f'<p><img src="{escaped(file)}" alt="{escaped(caption)}"></p>'


def whole(title, parts):
    return "\n".join(["<!DOCTYPE html>", '<html lang="en"><head><meta charset="utf-8">', f"<title>{escaped(title)}</title>",
                      f"<style>{STYLE}</style></head><body>", f"<h1>{escaped(title)}</h1>", *parts, "</body></html>"]) + "\n"
