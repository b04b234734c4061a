"""Table 1 and the figures of the paper: which runs each needs, and the part of the page that it becomes."""
import statistics

import charts
import models
import page
import published
import quality
import runs

GALLERY = ["buddha", "feline", "pensatore", "pelvis", "david"]  # figure 6, from left to right
CLOSE = "buddha"  # figure 5
# Figure 9. It does not say what its model is; ours is made in code, so that the grid is the same everywhere.
GRID_MODEL, GRID_RHO, GRID_ETA = "statue", (0.3, 0.6, 1.2), (1.05, 1.2, 1.8)
# Figure 11.
ERROR_MODELS, ERROR_RHO = ("bunny", "max", "dragon", "feline", "statue", "pelvis"), (0.2, 0.35, 0.5, 0.75, 1.0, 1.25, 1.5)
BLUE, ORANGE = "#2f6db3", "#d9652b"


def title(name):
    text = models.MODELS[name].title
    return text[0].upper() + text[1:]


def thousands(count):
    return f"{count / 1000:.1f}"


def three(row):
    return f"{row['worst']:.2f} / {row['half_percentile']:.2f} / {row['median']:.3f}"


def done(row):
    return "error_pct" in row


class Part:
    """One table or figure. Timed: its runs are taken against the clock."""
    name, heading, timed = "", "", False

    def wanted(self):
        """(model, rho, eta) of every run."""
        return []

    def section(self, laboratory, rows):
        """HTML; rows: those of wanted() that have been made, by (model, rho, eta)."""
        raise NotImplementedError

    def claims(self, rows):
        """[(what the paper says, whether it holds here, how it is)]"""
        return []


class Table1(Part):
    name, heading, timed = "table1", "Table 1: parameters, error, quality and time", True

    def wanted(self):
        return [(name, row.rho, published.ETA) for name, rows in published.TABLE_1.items() for row in rows]

    def section(self, laboratory, rows):
        head = ["model", "rho", "in, paper", "in, here", "out, paper", "out, here", "error, paper", "error, here", "rms, here",
                "2r/R here: worst / 0.5 % / median", "s, paper", "s, here", "clock ÷ ours", "MB, paper", "MB, here"]
        lines = [self.line(name, printed, rows[name, printed.rho, published.ETA]) for name, all_rows in published.TABLE_1.items()
                 for printed in all_rows if (name, printed.rho, published.ETA) in rows]
        note = ("Triangles in thousands; error is the symmetric Hausdorff distance, in percent of the bounding box's diagonal. Seconds are "
                "those of the engine on one core, the fastest of the runs; the paper's are of a 3.0 GHz Pentium D. Clock ÷ ours: how many "
                "times longer the clock took for as many triangles, on the same core, by turns. Bold: the input has the paper's size, and ours is not "
                "worse. Where the input's size is another, the rows show the same parameters, not the same task.")
        return page.table(head, lines, left=1) + page.paragraph(note) + self.clock_notes(rows)

    def line(self, name, printed, row):
        head = [title(name), f"{printed.rho:g}", f"{published.INPUT[name]:.1f}"]
        if not done(row):
            return [*head, page.Failed("; ".join(row["problems"]))]
        alike = same_input(row)
        error = (f"{row['error_pct']:.3f}", "better" if alike and row["error_pct"] <= printed.error else "")
        line = [*head, thousands(row["input_triangles"]), f"{printed.out:.1f}", thousands(row["triangles"]), f"{printed.error:.2f}", error,
                f"{row['rms_pct']:.4f}", three(row), f"{printed.seconds:.1f}", f"{runs.seconds_of(row):.2f}",
                f"{runs.ratio_of(row):.2f}" if runs.ratio_of(row) else "–", f"{published.MEMORY.get(name, '–')}",
                f"{row['memory_mb']:.0f}"]
        return [*line[:9], page.Failed("; ".join(row["problems"]))] if row["problems"] else line

    def clock_notes(self, rows):
        said = [f"{title(name)} at rho {rho:g}: {row['clock_said']}" for (name, rho, _), row in rows.items() if "clock_said" in row]
        return page.paragraph("The clock did not finish: " + "; ".join(said)) if said else ""

    def claims(self, rows):
        found = []
        for (name, rho, _), row in rows.items():
            if done(row) and same_input(row):
                printed = next(p for p in published.TABLE_1[name] if p.rho == rho)
                holds = row["error_pct"] <= printed.error and not row["problems"]
                found.append((f"{title(name)} at rho {rho:g}: an error of {printed.error:.2f} %", holds,
                              f"{row['error_pct']:.3f} %, with {row['triangles'] / 1000 / printed.out:.2f} times the triangles{went(row)}"))
        return found


def went(row):
    return ", in a run that went wrong" if row["problems"] else ""


def same_input(row):
    """Within 1 % of the paper's, and of the model itself."""
    wanted = published.INPUT.get(row["model"])
    return bool(wanted and models.MODELS[row["model"]].file and abs(row["input_triangles"] / 1000 / wanted - 1) < 0.01)


class Figure5(Part):
    name, heading = "figure5", "Figure 5: the Buddha, close"

    def wanted(self):
        return [(CLOSE, row.rho, published.ETA) for row in published.TABLE_1[CLOSE]]

    def section(self, laboratory, rows):
        grid = [[shown(laboratory, name, None, close=True), shown(laboratory, name, row, close=True)] for (name, _, _), row in rows.items()]
        return page.pictures(grid) + page.paragraph("Left: the input. Right: the result. Blue: well shaped, orange: slivers, red: seen from behind.")


class Figure6(Part):
    name, heading = "figure6", "Figure 6: results of the algorithm"

    def wanted(self):
        return [(name, row.rho, published.ETA) for name in GALLERY + [n for n in published.TABLE_1 if n not in GALLERY]
                for row in published.TABLE_1[name]]

    def section(self, laboratory, rows):
        grid = []
        for name in dict.fromkeys(name for name, _, _ in rows):
            mine = [row for row in rows.values() if row["model"] == name]
            line = [shown(laboratory, name, None), *(shown(laboratory, name, row) for row in mine)]
            if len(mine) == 1:
                line += [shown(laboratory, name, None, close=True), shown(laboratory, name, mine[0], close=True)]
            grid.append(line)
        return page.pictures(grid)


def shown(laboratory, name, row, close=False):
    """(picture, caption) of the input, or of a result."""
    mesh = laboratory.input_mesh(name) if row is None else laboratory.mesh(name, row["rho"], row["eta"])
    file = laboratory.picture(mesh, laboratory.input_mesh(name), models.MODELS[name].close if close else None)
    if row is None:
        known = laboratory.input_quality(name)
        return file, f"{title(name)}: {thousands(known.triangles)}k triangles" if known else f"{title(name)}: no input"
    if not done(row):
        return file, f"rho {row['rho']:g}: " + "; ".join(row["problems"])
    return file, f"rho {row['rho']:g}: {thousands(row['triangles'])}k"


class Figure9(Part):
    name, heading = "figure9", "Figure 9: the effects of rho and eta"

    def wanted(self):
        return [(GRID_MODEL, rho, eta) for rho in GRID_RHO for eta in GRID_ETA]

    def section(self, laboratory, rows):
        grid = [[self.cell(laboratory, rows[GRID_MODEL, rho, eta]) for eta in GRID_ETA] for rho in GRID_RHO]
        lines = [[f"{row['rho']:g}", f"{row['eta']:g}", *self.numbers(row)] for row in rows.values()]
        return (page.pictures(grid) + page.table(["rho", "eta", "triangles", "error, %", "2r/R: worst / 0.5 % / median"], lines, left=2)
                + page.paragraph(f"{title(GRID_MODEL)}. Down: rho; to the right: eta. At a sample itself eq. 5 wants l/eta, not l: where samples are "
                                 "dense, as here, a large eta makes more triangles again."))

    def cell(self, laboratory, row):
        file, _ = shown(laboratory, GRID_MODEL, row)
        return file, f"rho {row['rho']:g}, eta {row['eta']:g}: {row.get('triangles', 'no')} triangles"

    def numbers(self, row):
        if row["problems"] or not done(row):
            return [page.Failed("; ".join(row["problems"]))]
        return [f"{row['triangles']}", f"{row['error_pct']:.3f}", three(row)]

    def claims(self, rows):
        made = {(rho, eta): row for (_, rho, eta), row in rows.items() if done(row)}
        if len(made) < len(GRID_RHO) * len(GRID_ETA):
            return []
        coarser = all(made[a, eta]["triangles"] > made[b, eta]["triangles"] for a, b in zip(GRID_RHO, GRID_RHO[1:]) for eta in GRID_ETA)
        small, usual, _ = GRID_ETA
        share = [made[rho, small]["triangles"] / made[rho, usual]["triangles"] for rho in GRID_RHO]
        poorer = all(made[rho, a]["half_percentile"] > made[rho, b]["half_percentile"] for a, b in zip(GRID_ETA, GRID_ETA[1:]) for rho in GRID_RHO)
        return [("a bigger rho results in a coarser triangulation", coarser, "at every eta" if coarser else "not at every eta"),
                ("a small eta sizes triangles much smaller than required", min(share) > 1.2,
                 f"{min(share):.2f} to {max(share):.2f} times as many at {small:g} as at {usual:g}"),
                ("a larger eta results in more triangles with poor aspect ratios", poorer, "at every rho" if poorer else "not at every rho")]


class Figure10(Part):
    """Of all runs that the other parts made."""
    name, heading = "figure10", "Figure 10: quality of the triangles, before and after"

    def wanted(self):
        return Table1().wanted()

    def section(self, laboratory, rows):
        every = [row for row in laboratory.rows.values() if done(row)]
        inputs = [found for name in dict.fromkeys(row["model"] for row in every) if (found := laboratory.input_quality(name))]
        panels = [self.panel(f"{len(inputs)} inputs", [found.bins for found in inputs], ORANGE),
                  self.panel(f"{len(every)} remeshes", [row["bins"] for row in every], BLUE)]
        (laboratory.out / "figure10.svg").write_text(charts.svg(panels, width=460, height=340), encoding="utf-8")
        lines = [["the inputs", *spread([found._asdict() for found in inputs])], ["the remeshes", *spread(every)]] if every else []
        return (page.image("figure10.svg", "cumulative histograms of 2r/R") + page.table(["", "worst of all", "0.5 %", "median"], lines)
                + page.paragraph("Each curve is a mesh: the share of its triangles whose 2r/R is at most the number below. The inputs are as they "
                                 "were meshed, after repair, which takes away what has no area at all."))

    def panel(self, name, all_bins, color):
        curves = []
        for bins in all_bins:
            total, sum_, points = sum(bins), 0, [(0.0, 0.0)]
            for i, count in enumerate(bins):
                sum_ += count
                points.append(((i + 1) / quality.BINS, sum_ / total))
            curves.append(charts.Curve(points, color, width=1.4, opacity=0.55))
        return charts.Panel(name, charts.Axis("2r/R", 0, 1), charts.Axis("share of triangles", 0, 1), curves,
                            [("x", published.HALF_PERCENTILE, "paper: 0.5 % below")])

    def claims(self, rows):
        every = [row for row in rows.values() if done(row)]
        if not every:
            return []
        triangles = sum(row["triangles"] for row in every)
        least = {what: min(every, key=lambda row, what=what: row[what]) for what in ("worst", "half_percentile", "median")}

        def worst_of(what):
            row = least[what]
            return f"{row[what]:.3f} or better ({title(row['model'])}, rho {row['rho']:g}, eta {row['eta']:g}{went(row)})"
        return [("the first half percentile of all remeshes has a ratio of 0.5 or better",
                 least["half_percentile"]["half_percentile"] >= published.HALF_PERCENTILE, worst_of("half_percentile")),
                ("all have a median ratio within 3 % of optimal", least["median"]["median"] >= published.MEDIAN, worst_of("median")),
                ("the worst triangle, of 30 million, has a ratio greater than 1/8", least["worst"]["worst"] > published.WORST,
                 f"{worst_of('worst')}, of {triangles / 1e6:.2f} million")]


def spread(rows):
    """Worst of all; lowest to highest half percentile, and median."""
    parts = [f"{min(row['worst'] for row in rows):.3g}"]
    for what in ("half_percentile", "median"):
        parts.append(f"{min(row[what] for row in rows):.3f} … {max(row[what] for row in rows):.3f}")
    return parts


class Figure11(Part):
    name, heading = "figure11", "Figure 11: predicted error and measured error"

    def wanted(self):
        return [(name, rho, published.ETA) for name in ERROR_MODELS for rho in ERROR_RHO]

    def section(self, laboratory, rows):
        by_model = {}
        for (name, _, _), row in rows.items():
            if done(row) and not row["problems"]:
                by_model.setdefault(name, []).append(row)
        if by_model:
            (laboratory.out / "figure11.svg").write_text(charts.svg([self.panel(name, mine) for name, mine in by_model.items()]), encoding="utf-8")
        lines = [self.line(name, rho, row) for (name, rho, _), row in rows.items()]
        head = ["model", "rho", "in", "out", "predicted, %", "measured, %", "measured ÷ predicted"]
        chart = page.image("figure11.svg", "predicted and measured error over rho") if by_model else ""
        return (chart + page.table(head, lines)
                + page.paragraph("In percent of the bounding box's diagonal. Predicted: eq. 7. Measured: the symmetric Hausdorff distance, where "
                                 "the paper has Metro's. Bold: fewer triangles than in the input. Runs that went wrong are in the table alone."))

    def panel(self, name, mine):
        values = [row[what] for row in mine for what in ("bound_pct", "error_pct")]
        y = charts.Axis("% of the diagonal", min(values) * 0.7, max(values) * 1.4, True)
        curves = [charts.Curve([(row["rho"], row[what]) for row in mine], color, label, dashed=dashed, dots=True)
                  for what, color, label, dashed in (("bound_pct", ORANGE, "predicted", True), ("error_pct", BLUE, "measured", False))]
        crossing = [row["rho"] for row in mine if row["triangles"] < row["input_triangles"]]
        guides = [("x", min(crossing), "fewer than in")] if crossing and min(crossing) > mine[0]["rho"] else []
        return charts.Panel(title(name), charts.Axis("rho", 0, 1.6), y, curves, guides)

    def line(self, name, rho, row):
        head = [title(name), f"{rho:g}"]
        if row["problems"] or not done(row):
            return [*head, page.Failed("; ".join(row["problems"]))]
        fewer = row["triangles"] < row["input_triangles"]
        return [*head, thousands(row["input_triangles"]), (thousands(row["triangles"]), "better" if fewer else ""), f"{row['bound_pct']:.3f}",
                f"{row['error_pct']:.3f}", f"{row['error_pct'] / row['bound_pct']:.2f}"]

    def claims(self, rows):
        coarse = [row for row in rows.values() if done(row) and not row["problems"] and row["triangles"] < row["input_triangles"]]
        if not coarse:
            return []
        shares = sorted(row["error_pct"] / row["bound_pct"] for row in coarse)
        most = max(coarse, key=lambda row: row["error_pct"] / row["bound_pct"])
        return [("with fewer triangles than the input, the measured error is about half of the predicted one",
                 abs(statistics.median(shares) - published.MEASURED_BY_PREDICTED) <= 0.2,
                 f"the median of {len(shares)} is {statistics.median(shares):.2f}, from {shares[0]:.2f} to {shares[-1]:.2f}"),
                ("and never above it", shares[-1] <= 1, f"at most {shares[-1]:.2f} of it ({title(most['model'])}, rho {most['rho']:g})")]


PARTS = [Figure5(), Figure6(), Table1(), Figure9(), Figure10(), Figure11()]
