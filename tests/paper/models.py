"""The models of the paper: files from beside the repository, or shapes made in code where there is no such file.

    models = PaperModels(data, out, scale=1.0)
    models.missing()               the names of those whose file is not there
    models.path("bunny")           its file, unpacked or made below OUT when first asked for
"""
import collections
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "corpus"))
import corpus
import shapes

# title: as the page calls it. file: below the data folder; none: it is made by `make`, of `size` triangles times the scale.
# Where the paper shows it close: center of the picture in the box of the model, 0 to 1 along each axis, and how much larger.
# up: the axis that is up, where it is not what shows more.
Model = collections.namedtuple("Model", "title file make size close up", defaults=(None, None, 0, ((0.5, 0.5, 0.5), 4), None))


def statue(seed):
    return lambda size: shapes.statue(max(2, round(math.sqrt(size / 20))), seed)


# Triangles times the square of the cell's size.
BONE = 116.4


def bone(size):
    return shapes.bone(math.sqrt(BONE / size))


MODELS = {
    "bunny": Model("Bunny", "scans/bunny.off"),
    "max": Model("Max", "scans/max_planck_20k.obj"),
    "dragon": Model("Dragon", "scans/dragon_100k.ply"),
    "feline": Model("Feline", "scans/feline_41k.obj.gz"),
    "pelvis": Model("an iso-surface, in place of Pelvis", make=bone, size=529800, close=((0.5, 0.7, 0.8), 6)),
    "david": Model("a generated scan, in place of David", make=statue(1), size=1300800, close=((0.5, 0.2, 0.5), 5)),
    "pensatore": Model("a generated scan, in place of Pensatore", make=statue(5), size=1995700, close=((0.5, 0.3, 0.5), 5)),
    "buddha": Model("Buddha", "scans/buddha_51k.obj.gz", close=((0.5, 0.5, 0.8), 4), up="z"),
    "statue": Model("a generated scan of 200k", make=statue(1), size=200000),
}


class PaperModels:
    def __init__(self, data, out, scale):
        self.files = corpus.Models(pathlib.Path(data), out)
        self.made, self.scale = out / "generated", scale

    def missing(self):
        """Names of those whose file is not there."""
        return [name for name, model in MODELS.items() if model.file and not (self.files.data / model.file).exists()]

    def size(self, name):
        return MODELS[name].size * self.scale

    def path(self, name):
        model = MODELS[name]
        if model.file:
            return self.files.path(model.file)
        made = self.made / f"{name}-{self.size(name):.0f}.ply"
        if not made.exists():
            print(f"making {model.title} ({self.size(name) / 1000:.0f} thousand triangles)", flush=True)
            made.parent.mkdir(parents=True, exist_ok=True)
            begun = made.with_name("begun-" + made.name)
            shapes.write_ply(begun, *model.make(self.size(name)))
            begun.rename(made)
        return made
