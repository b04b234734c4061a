"""Line charts as SVG: several panels in a row, each with its curves, linear or logarithmic axes.

    svg = charts.svg([Panel("bunny", x=Axis("rho", 0, 1.5), y=Axis("error, %", 0.01, 1, log=True), curves=[Curve(points, "#06c", "measured")])])
"""
import collections
import html
import math

# A caption below the axis, and what it spans.
Axis = collections.namedtuple("Axis", "caption low high log", defaults=(False,))
# label: in the panel's legend; none: it is not there. dots: marks at the points.
Curve = collections.namedtuple("Curve", "points color label width opacity dashed dots", defaults=("", 1.8, 1.0, False, False))
# guides: (x or y, value, text), dashed lines across the panel.
Panel = collections.namedtuple("Panel", "title x y curves guides", defaults=((),))

INK, GREY, RULE = "#262c38", "#787e88", "#d9dce0"
LEFT, RIGHT, TOP, BOTTOM = 58, 14, 34, 46  # around the plot, in pixels
LEGEND_LINE = 16
DASHES = {True: ' stroke-dasharray="6 4"', False: ""}


def svg(panels, width=400, height=300, columns=3):
    columns = min(columns, len(panels))
    rows = math.ceil(len(panels) / columns)
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width * columns}" height="{height * rows}" '
             f'viewBox="0 0 {width * columns} {height * rows}" font-family="sans-serif" font-size="12">',
             f'<rect width="100%" height="100%" fill="#fff"/>']
    for i, panel in enumerate(panels):
        parts.append(f'<g transform="translate({width * (i % columns)} {height * (i // columns)})">')
        parts += drawn(panel, width, height)
        parts.append("</g>")
    return "\n".join([*parts, "</svg>"]) + "\n"


def share(axis, value):
    """0 at the low end of the axis, 1 at the high one."""
    if axis.log:
        return (math.log(max(value, axis.low)) - math.log(axis.low)) / (math.log(axis.high) - math.log(axis.low))
    return (value - axis.low) / (axis.high - axis.low)


def ticks(axis):
    if axis.log:
        decades = range(math.floor(math.log10(axis.low)), math.ceil(math.log10(axis.high)) + 1)
        candidates = [m * 10.0 ** d for d in decades for m in (1, 2, 5)]
    else:
        raw = (axis.high - axis.low) / 5
        unit = 10.0 ** math.floor(math.log10(raw))
        step = next(unit * m for m in (1, 2, 5, 10) if unit * m >= raw * 0.999)
        candidates = [step * i for i in range(math.ceil(axis.low / step), math.floor(axis.high / step + 1e-9) + 1)]
    return [value for value in candidates if axis.low * (1 - 1e-9) <= value <= axis.high * (1 + 1e-9)]


def text(x, y, words, color=INK, anchor="start", more=""):
    return f'<text x="{x:.1f}" y="{y:.1f}" fill="{color}" text-anchor="{anchor}"{more}>{html.escape(words)}</text>'


def line(x0, y0, x1, y1, color, dashed=False):
    return f'<path d="M{x0:.1f} {y0:.1f}L{x1:.1f} {y1:.1f}" stroke="{color}" fill="none"{DASHES[dashed]}/>'


def drawn(panel, width, height):
    right, bottom = width - RIGHT, height - BOTTOM

    def place(x, y):
        return LEFT + share(panel.x, x) * (right - LEFT), bottom - share(panel.y, y) * (bottom - TOP)

    parts = [text(LEFT, TOP - 12, panel.title, more=' font-weight="bold"')]
    for value in ticks(panel.x):
        x, _ = place(value, panel.y.low)
        parts += [line(x, TOP, x, bottom, RULE), text(x, bottom + 16, f"{value:g}", GREY, "middle")]
    for value in ticks(panel.y):
        _, y = place(panel.x.low, value)
        parts += [line(LEFT, y, right, y, RULE), text(LEFT - 6, y + 4, f"{value:g}", GREY, "end")]
    parts += [text((LEFT + right) / 2, height - 10, panel.x.caption, INK, "middle"),
              text(0, 0, panel.y.caption, INK, "middle", f' transform="translate(16 {(TOP + bottom) / 2:.1f}) rotate(-90)"')]
    for way, value, words in panel.guides:
        if way == "x":
            x, _ = place(value, panel.y.low)
            beside, anchor = (x + 4, "start") if x < (LEFT + right) / 2 else (x - 4, "end")
            parts += [line(x, TOP, x, bottom, GREY, True), text(beside, TOP + 12, words, GREY, anchor)]
        else:
            _, y = place(panel.x.low, value)
            parts += [line(LEFT, y, right, y, GREY, True), text(right - 4, y - 4, words, GREY, "end")]
    for curve in panel.curves:
        parts += traced(curve, place)
    parts += legend(panel, right, bottom)
    return parts


def traced(curve, place):
    places = [place(x, y) for x, y in curve.points]
    path = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in places)
    style = f'stroke="{curve.color}" stroke-width="{curve.width}" stroke-opacity="{curve.opacity}" fill="none"'
    parts = [f'<path d="{path}" {style}{DASHES[curve.dashed]}/>']
    return parts + [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.6" fill="{curve.color}"/>' for x, y in places if curve.dots]


def legend(panel, right, bottom):
    named = [curve for curve in panel.curves if curve.label]
    parts = []
    for i, curve in enumerate(named):
        y = bottom - 10 - LEGEND_LINE * (len(named) - 1 - i)
        parts += [f'<path d="M{right - 30} {y - 4}h24" stroke="{curve.color}" stroke-width="2"{DASHES[curve.dashed]}/>',
                  text(right - 36, y, curve.label, INK, "end")]
    return parts
