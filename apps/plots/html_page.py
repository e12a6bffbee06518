"""Writer of HTML pages other than that of `mixbeam view`: text from a scene is data, never markup."""

import base64
import html
import io
from urllib.parse import quote

from command import InputError, whole_file

MOST_ROWS = 40      # of a table; the result file has all
DIGITS = 4          # of numbers in tables
DOTS_PER_INCH = 90  # of pictures, so that a page stays below 2 MB
STYLE = ("body{font:15px/1.45 system-ui,sans-serif;max-width:62em;margin:2em auto;padding:0 1em;color:#222}"
         "table{border-collapse:collapse;margin:.6em 0}td,th{padding:.15em .8em .15em 0;text-align:right;border-bottom:1px "
         "solid #ddd}td:first-child,th:first-child,.words{text-align:left}img{max-width:100%}pre{background:#f6f6f6;padding:1em;"
         "overflow:auto;font-size:12px}.bad{color:#b00;font-weight:600}i.bar{display:inline-block;height:.7em;background:#9fbcd6}"
         "i.bar.bad{background:#b00}@media screen and (max-width:50em){table{display:block;overflow-x:auto}td:first-child{min-width:9em}"
         "i.bar{max-width:5em}}td{vertical-align:top;max-width:34em}nav a{margin-right:1em}@page{margin:18mm 15mm}"
         "@media print{body{font-size:10pt;margin:0;max-width:none}nav,details{display:none}h2{break-after:avoid}"
         "tr,img,svg{break-inside:avoid}thead{display:table-header-group}}")
# The policy forbids any request to a server and any script, whatever the page contains.
BEGIN = "<!doctype html>"
POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data: blob:"


class Cell:
    """Cell of a table: markup of this program, with an alternative text for screen readers."""

    def __init__(self, text, markup):
        self.markup = f"<span role=\"img\" aria-label=\"{html.escape(text, quote=True)}\">{markup}</span>"


def bar(share, is_bad=False):
    """Returns a Cell with a bar of `share` (0 to 1) of the full length."""
    return Cell(f"{share:.3g}", f"<i class=\"bar{' bad' if is_bad else ''}\" style=\"width:{12 * min(max(share, 0.0), 1.0):.3g}em\"></i>")


class Page:
    """One self-contained HTML file without scripts. All texts are plain."""

    def __init__(self, title):
        self._parts = [f"{BEGIN}<html lang=\"en\"><head><meta charset=\"utf-8\">"
                       f"<meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">"
                       f"<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
                       f"<title>{html.escape(title)}</title><style>{STYLE}</style></head><body>"]
        self._headings, self._contents = [], None

    def title(self, text):
        self._parts.append(f"<h1>{html.escape(text)}</h1>")

    def contents(self):
        """Inserts links to all headings here."""
        self._contents = len(self._parts)
        self._parts.append("")

    def heading(self, text):
        self._headings.append(text)
        self._parts.append(f"<h2 id=\"part{len(self._headings)}\">{html.escape(text)}</h2>")

    def text(self, text, bad=False):
        self._parts.append(f"<p{' class=bad' if bad else ''}>{html.escape(text)}</p>")

    def link(self, words, file_name):
        """Adds a link to a file in the same folder."""
        self._parts.append(f"<p><a href=\"./{html.escape(quote(file_name), quote=True)}\">{html.escape(words)}</a></p>")

    def table(self, head, rows):
        """Adds a table of the first MOST_ROWS rows; entries are texts, numbers or Cells."""
        words = [any(isinstance(row[i], (str, Cell)) and row[i] for row in rows[:MOST_ROWS]) for i in range(len(head))]

        def cells(tag, row):
            marks = [cell.markup if isinstance(cell, Cell) else html.escape(cell_text(cell)) for cell in row]
            return "".join(f"<{tag}{' class=words' if is_word else ''}>{mark}</{tag}>" for mark, is_word in zip(marks, words))

        self._parts.append("<table><thead><tr>" + cells("th", head) + "</tr></thead>")
        self._parts += ["<tr>" + cells("td", row) + "</tr>" for row in rows[:MOST_ROWS]]
        self._parts.append("</table>")
        if len(rows) > MOST_ROWS:
            self.text(f"... and {len(rows) - MOST_ROWS} more in the result file.")

    def picture(self, canvas, words, style):
        data = io.BytesIO()
        canvas.savefig(data, format="png", dpi=DOTS_PER_INCH, bbox_inches=style.lay_out(canvas))
        style.plt.close(canvas)
        code = base64.b64encode(data.getvalue()).decode()
        self._parts.append(f"<p><img alt=\"{html.escape(words, quote=True)}\" src=\"data:image/png;base64,{code}\"></p>")

    def folded(self, title, text):
        self._parts.append(f"<details><summary>{html.escape(title)}</summary><pre>{html.escape(text)}</pre></details>")

    def markup(self):
        """Returns the whole page as text."""
        if self._contents is not None:
            self._parts[self._contents] = "<nav>" + "".join(
                f"<a href=\"#part{i}\">{html.escape(text)}</a>" for i, text in enumerate(self._headings, 1)) + "</nav>"
        return "\n".join(self._parts) + "\n</body></html>\n"

    def write(self, path):
        """Writes the page atomically. Raises InputError if the name belongs to a file that is not a page."""
        if path.is_file() and path.stat().st_size and path.open("rb").read(len(BEGIN)) != BEGIN.encode():
            raise InputError(f"{path}: is there and is no page, and is not written over; allowed: another name")
        with whole_file(path) as stream:
            stream.write(self.markup().encode("utf-8", "replace"))


def page_beside(file, kind):
    """Returns the path of a page (view, report) of a result file or a scene: `mine-view.html`."""
    return file.with_name(f"{file.stem}-{kind}.html")


def cell_text(value):
    return value if isinstance(value, str) else f"{value:.{DIGITS}g}" if isinstance(value, float) else str(value)
