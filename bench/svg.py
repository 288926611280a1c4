"""Small pieces of SVG, written by hand: a document and a plot with logarithmic axes."""

import math

INK, GRID, PAPER = "#222222", "#dddddd", "#ffffff"
FONT = "font-family='DejaVu Sans, Helvetica, sans-serif'"


class Document:
    def __init__(self, width, height):
        self.width, self.height, self.parts = width, height, []

    def add(self, text):
        self.parts.append(text)

    def text(self, x, y, words, size=12, anchor="start", colour=INK, turn=0, weight="normal"):
        rotation = f" transform='rotate({turn} {x:g} {y:g})'" if turn else ""
        words = words.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
        self.add(f"<text x='{x:g}' y='{y:g}' font-size='{size}' text-anchor='{anchor}' fill='{colour}' "
                 f"font-weight='{weight}' {FONT}{rotation}>{words}</text>")

    def line(self, x1, y1, x2, y2, colour=INK, width=1.0, dash=""):
        dashes = f" stroke-dasharray='{dash}'" if dash else ""
        self.add(f"<line x1='{x1:g}' y1='{y1:g}' x2='{x2:g}' y2='{y2:g}' stroke='{colour}' stroke-width='{width}'{dashes}/>")

    def rectangle(self, x, y, width, height, fill="none", stroke="none", stroke_width=1.0):
        self.add(f"<rect x='{x:g}' y='{y:g}' width='{width:g}' height='{height:g}' fill='{fill}' stroke='{stroke}' "
                 f"stroke-width='{stroke_width}'/>")

    def __str__(self):
        head = (f"<svg xmlns='http://www.w3.org/2000/svg' width='{self.width}' height='{self.height}' "
                f"viewBox='0 0 {self.width} {self.height}'>")
        paper = f"<rect width='{self.width}' height='{self.height}' fill='{PAPER}'/>"
        return "\n".join([head, paper, *self.parts, "</svg>"]) + "\n"


def power_label(exponent):
    raised = str(exponent).translate(str.maketrans("-0123456789", "\u207b\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079"))
    return "1" if exponent == 0 else ("10" if exponent == 1 else f"10{raised}")


class LogPlot:
    """A frame with two logarithmic axes inside a document; x and y ranges in powers of ten."""

    def __init__(self, document, box, x_range, y_range, title="", x_label="", y_label=""):
        self.document, self.box, self.x_range, self.y_range = document, box, x_range, y_range
        left, top, width, height = box
        document.rectangle(left, top, width, height, fill="#fcfcfc", stroke=INK)
        for e in range(math.ceil(x_range[0]), math.floor(x_range[1]) + 1):
            x = self._x(10.0 ** e)
            document.line(x, top, x, top + height, GRID, 0.6)
            document.text(x, top + height + 15, power_label(e), 10, "middle")
        step = 1 if y_range[1] - y_range[0] <= 6 else 2
        for e in range(math.ceil(y_range[0]), math.floor(y_range[1]) + 1):
            if e % step:
                continue
            y = self._y(10.0 ** e)
            document.line(left, y, left + width, y, GRID, 0.6)
            document.text(left - 6, y + 3.5, power_label(e), 10, "end")
        document.text(left + width / 2, top - 10, title, 12, "middle", weight="bold")
        document.text(left + width / 2, top + height + 32, x_label, 11, "middle")
        if y_label:
            document.text(left - 40, top + height / 2, y_label, 11, "middle", turn=-90)

    def _x(self, value):
        left, _, width, _ = self.box
        low, high = self.x_range
        return left + width * (math.log10(value) - low) / (high - low)

    def _y(self, value):
        _, top, _, height = self.box
        low, high = self.y_range
        return top + height * (high - math.log10(value)) / (high - low)

    def curve(self, points, colour, marks):
        """Points outside the frame are drawn on its edge: residuals below the axis are as good as zero."""
        def inside(value, limits):
            return min(max(value, 10.0 ** limits[0]), 10.0 ** limits[1])
        drawn = [(self._x(inside(x, self.x_range)), self._y(inside(y, self.y_range))) for x, y in points]
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in drawn)
        self.document.add(f"<polyline points='{path}' fill='none' stroke='{colour}' stroke-width='1.8' stroke-linejoin='round'/>")
        if marks:
            for x, y in drawn:
                self.document.add(f"<circle cx='{x:.1f}' cy='{y:.1f}' r='2.6' fill='{colour}'/>")
