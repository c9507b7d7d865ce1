"""Writes a ParaView state for a run: paraview.pvsm, to be opened by File > Load State, and a picture of it. Points are small balls in
colours of a field, walls grey, a mesh is bent by its displacement, image fields are shown through their middle plane.

    pvbatch contrib/plot/paraview.py FOLDER [--field von_mises] [--picture NAME.png] [--size 1600 1000]

pvbatch comes with ParaView (Debian: package paraview); without a screen: xvfb-run -a --wait=10 pvbatch ...
"""
import argparse
import math
import os
import re
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:] = [place for place in sys.path if os.path.abspath(place or ".") != HERE]  # this file has the module's name

from paraview import simple  # noqa: E402

simple._DisableFirstRenderCameraReset()
STEM = re.compile(r"_(?:per_)?(?:[numkMG]?(?:m|s|kg|g|N|Pa)|min|h)\d?(?:_per_(?:[num]?(?:m|s|kg|g)|min|h)\d?)*$")


def stem(name):
    """"von_mises" of "von_mises_Pa"."""
    return STEM.sub("", name)


def array_named(data, wanted):
    """The full name of a field of points or cells, "" if there is none."""
    names = [data[i].Name for i in range(data.GetNumberOfArrays())]
    return next((name for name in names if wanted in (name, stem(name))), "")


def opened(folder, name):
    """Reader of a list of files by time, at its last time; None where there is none, or one of files without names of fields, as NRRD."""
    path = os.path.join(folder, name)
    if not os.path.isfile(path):
        return None
    with open(path, encoding="utf-8") as file:
        if not re.search(r'file="[^"]*\.p?vt\w"', file.read()):
            return None
    reader = simple.OpenDataFile(path)
    simple.RenameSource(name, reader)
    reader.UpdatePipeline(list(reader.TimestepValues)[-1] if len(reader.TimestepValues) else 0.)
    return reader


def spacing(source):
    """Mean distance of the points, as if they filled their box."""
    info = source.GetDataInformation()
    low, high = info.GetBounds()[0::2], info.GetBounds()[1::2]
    edges = [b - a for a, b in zip(low, high) if b > a]
    return (math.prod(edges) / max(info.GetNumberOfPoints(), 1)) ** (1. / len(edges)) if edges else 1.


def colour(source, display, view, wanted, of="POINTS"):
    """By a field of points or cells, whose range at this time the bar has; the first of the names that there is. Returns its name."""
    data = source.PointData if of == "POINTS" else source.CellData
    name = next((found for found in (array_named(data, one) for one in wanted) if found), "")
    if not name:
        return ""
    array = data.GetArray(name)
    simple.ColorBy(display, (of, name, "Magnitude") if array.GetNumberOfComponents() > 1 else (of, name))
    table = simple.GetColorTransferFunction(name)
    table.ApplyPreset("Viridis (matplotlib)", True)
    low, high = array.GetRange(-1) if array.GetNumberOfComponents() > 1 else array.GetRange()
    table.RescaleTransferFunction(min(low, 0.), high if high > min(low, 0.) else min(low, 0.) + 1.)
    display.SetScalarBarVisibility(view, True)
    bar = simple.GetScalarBar(table, view)
    unit = name[len(stem(name)) + 1:].replace("_per_", "/")
    bar.Title = stem(name).replace("_", " ").replace("mises", "Mises") + (f" [{unit}]" if unit else "")
    bar.ComponentTitle = ""
    bar.TitleColor = bar.LabelColor = [0., 0., 0.]
    bar.TitleFontSize = bar.LabelFontSize = letters(view)
    bar.RangeLabelFormat = "%.3g"
    return name


def letters(view):
    """Size of letters in pixels: readable where a picture is as wide as a column of print."""
    return max(12, round(.03 * view.ViewSize[0]))


def show_points(source, view, wanted, size):
    """Balls that touch their neighbours at this distance."""
    display = simple.Show(source, view)
    display.SetRepresentationType("Point Gaussian")
    display.ShaderPreset = "Sphere"
    display.GaussianRadius = .72 * size  # no gaps along diagonals
    if wanted:
        return colour(source, display, view, wanted)
    display.ColorArrayName = ["POINTS", ""]
    display.AmbientColor = display.DiffuseColor = [.75, .75, .75]
    return ""


def show_grid(source, view, wanted, alone):
    """Its edges; if there are no points its fields too. A mesh that is not where the material is now is bent."""
    displacement = array_named(source.PointData, "displacement") or array_named(source.PointData, "displacement_since_reset")
    if displacement:
        source = simple.WarpByVector(Input=source, Vectors=["POINTS", displacement])
        source.UpdatePipeline()
    display = simple.Show(source, view)
    display.SetRepresentationType("Surface With Edges" if alone else "Wireframe")
    display.Opacity, display.LineWidth = (1., 1.) if alone else (.25, .5)
    display.AmbientColor = display.DiffuseColor = [.3, .3, .3]
    if alone:
        return colour(source, display, view, wanted)
    display.ColorArrayName = ["POINTS", ""]
    return ""


def show_voxels(source, view, wanted):
    """The middle plane across z."""
    bounds = source.GetDataInformation().GetBounds()
    if bounds[5] > bounds[4]:
        source = simple.Slice(Input=source)
        source.SliceType.Normal = [0., 0., 1.]
        source.SliceType.Origin = [.5 * (a + b) for a, b in zip(bounds[0::2], bounds[1::2])]
        source.UpdatePipeline()
    return colour(source, simple.Show(source, view), view, wanted, "CELLS")


def is_flat(source):
    bounds = source.GetDataInformation().GetBounds()
    return bounds[5] - bounds[4] <= 1e-9 * max(bounds[1] - bounds[0], bounds[3] - bounds[2])


def look(view, flat):
    """From in front in the plane, from above one side in space."""
    view.OrientationAxesVisibility = 1
    view.Background = [1., 1., 1.]
    view.UseColorPaletteForBackground = 0
    view.OrientationAxesLabelColor = [0., 0., 0.]
    if flat:
        view.InteractionMode = "2D"
        view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [0., 0., 1.], [0., 0., 0.], [0., 1., 0.]
    else:
        view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [.6, -1.2, 1.], [0., 0., 0.], [0., 0., 1.]
    simple.ResetCamera(view)


def build(folder, wanted, size):
    """The pipeline of whatever field files the folder has; returns the view and the field that is shown."""
    view = simple.CreateRenderView()
    view.ViewSize = size
    sources = {name: opened(folder, name + ".pvd") for name in ("points", "walls", "grid", "voxels")}
    points, grid, voxels = sources["points"], sources["grid"], sources["voxels"]
    shown = [source for source in sources.values() if source]
    if not shown:
        sys.exit(f"No state: {folder} holds no field files for ParaView (points.pvd, grid.pvd, or voxels.pvd of VTI)")
    found = show_points(points, view, wanted, spacing(points)) if points else ""
    if sources["walls"]:
        show_points(sources["walls"], view, [], spacing(points or sources["walls"]))
    if grid:
        found = show_grid(grid, view, wanted, not points) or found
    if voxels:
        found = show_voxels(voxels, view, wanted) or found
    simple.AnnotateTimeFilter(Input=shown[0], Format="{time:g} s")
    note = simple.Show(simple.GetActiveSource(), view)
    note.Color = [0., 0., 0.]
    note.FontSize = letters(view)
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    scene.GoToLast()
    look(view, is_flat(shown[0]))
    return view, found


def main():
    parser = argparse.ArgumentParser(description="Writes paraview.pvsm and a picture of a run. Run it by pvbatch.")
    parser.add_argument("folder", help="the run's results")
    parser.add_argument("--field", help="to colour by, with or without unit (default: von_mises, else velocity or the first)")
    parser.add_argument("--picture", default="paraview.png", help="in the folder (default: %(default)s)")
    parser.add_argument("--size", type=int, nargs=2, default=[1600, 1000], metavar=("WIDTH", "HEIGHT"), help="of the picture")
    arguments = parser.parse_args()
    folder = os.path.abspath(arguments.folder)  # of which a state has whole paths
    wanted = [arguments.field] if arguments.field else ["von_mises", "velocity", "displacement", "pressure"]
    view, found = build(folder, wanted, arguments.size)
    if arguments.field and not found:
        sys.exit(f"No state: {folder} has no field {arguments.field}")
    simple.SaveState(os.path.join(folder, "paraview.pvsm"))
    simple.SaveScreenshot(os.path.join(folder, arguments.picture), view, ImageResolution=arguments.size)
    print(f"State {os.path.join(folder, 'paraview.pvsm')}, picture {os.path.join(folder, arguments.picture)}, in colours of {found}")


main()
