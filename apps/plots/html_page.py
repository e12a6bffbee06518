"""The only writer of HTML pages: what comes from a scene is data, never markup."""

import base64
import html
import io

from command import InputError, whole_file

MOST_ROWS = 40      # of a table; the result file has all
DOTS_PER_INCH = 90  # of pictures, so that a page stays below 2 MB
STYLE = ("body{font:15px/1.45 system-ui,sans-serif;max-width:62em;margin:2em auto;padding:0 1em;color:#222}"
         "table{border-collapse:collapse;margin:.6em 0}td,th{padding:.15em .8em .15em 0;text-align:right;border-bottom:1px "
         "solid #ddd}td:first-child,th:first-child{text-align:left}img{max-width:100%}pre{background:#f6f6f6;padding:1em;"
         "overflow:auto;font-size:12px}.bad{color:#b00;font-weight:600}")
# A page asks no server for anything, whatever is in it, and runs no script but its own.
BEGIN = "<!doctype html>"
POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data: blob:"


class Page:
    """One HTML file without network. All texts are plain; `style` and what `add_own` gets are files of this program."""

    def __init__(self, title, style=STYLE, has_scripts=False):
        policy = POLICY + ("; script-src 'unsafe-inline'" if has_scripts else "")
        self._parts = [f"{BEGIN}<html lang=\"en\"><head><meta charset=\"utf-8\">"
                       f"<meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">"
                       f"<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
                       f"<title>{html.escape(title)}</title><style>{style}</style></head><body>"]

    def title(self, text):
        self._parts.append(f"<h1>{html.escape(text)}</h1>")

    def heading(self, text):
        self._parts.append(f"<h2>{html.escape(text)}</h2>")

    def text(self, text, bad=False):
        self._parts.append(f"<p{' class=bad' if bad else ''}>{html.escape(text)}</p>")

    def link(self, words, file_name):
        """To a file in the same folder."""
        self._parts.append(f"<p><a href=\"{html.escape(file_address(file_name), quote=True)}\">{html.escape(words)}</a></p>")

    def table(self, head, rows):
        """The first MOST_ROWS rows; numbers with six digits."""
        cells = lambda tag, row: "".join(f"<{tag}>{html.escape(cell_text(cell))}</{tag}>" for cell in row)
        self._parts.append("<table><tr>" + cells("th", head) + "</tr>")
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

    def packed(self, name, data):
        """Deflated bytes that scripts of the page read: letters and digits, which the browser does not look at until they are
        asked for."""
        code = base64.b64encode(data).decode()
        self._parts.append(f"<script type=\"application/octet-stream\" id=\"{html.escape(name, quote=True)}\">{code}</script>")

    def add_own(self, markup="", script=""):
        """Markup and script that belong to this program."""
        self._parts.append(markup + (f"<script>\n{script}\n</script>" if script else ""))

    def write(self, path):
        """Only whole pages appear under the name, and replace nothing but pages."""
        if path.is_file() and path.stat().st_size and path.open("rb").read(len(BEGIN)) != BEGIN.encode():
            raise InputError(f"{path}: is there and is no page, and is not written over; allowed: another name")
        with whole_file(path) as stream:
            stream.write(("\n".join(self._parts) + "\n</body></html>\n").encode("utf-8", "replace"))


def view_beside(result):
    """Where `mixbeam view` writes its page of a result file."""
    return result.with_name(f"{result.stem}-view.html")


def file_address(file_name):
    """Relative address of a file of any name in the same folder."""
    from urllib.parse import quote

    return "./" + quote(file_name)


def cell_text(value):
    return value if isinstance(value, str) else f"{value:.6g}" if isinstance(value, float) else str(value)
