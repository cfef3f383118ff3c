#!/usr/bin/python3
"""Picture of a tet mesh: its surface on the left, the tets behind a cut on the right, coloured by mean ratio.

usage: xvfb-run -a tools/docs/render.py duck/3-mesh/mesh.vtu docs/duck.png [--up y] [--cut x]
Needs Debian's python3-vtk9, xvfb and libgl1-mesa-dri.
"""
import argparse

import vtk

AXES = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}


def view(port, up, cut, center, size):
    r = vtk.vtkRenderer()
    r.SetViewport(*port)
    r.SetBackground(1, 1, 1)
    camera = r.GetActiveCamera()
    right = [b * c - a * d for (a, c), (b, d) in
             (((up[2], cut[1]), (up[1], cut[2])), ((up[0], cut[2]), (up[2], cut[0])), ((up[1], cut[0]), (up[0], cut[1])))]
    camera.SetFocalPoint(center)
    camera.SetPosition([center[i] + size * (1.6 * cut[i] + 0.75 * right[i] + 0.55 * up[i]) for i in range(3)])
    camera.SetViewUp(up)
    camera.SetViewAngle(24)
    return r


def actor(port, edges, array, opacity=1.0):
    mapper = vtk.vtkDataSetMapper()
    mapper.SetInputConnection(port)
    table = vtk.vtkLookupTable()
    table.SetHueRange(0.02, 0.58)
    table.SetSaturationRange(0.55, 0.45)
    table.SetTableRange(0.7, 1.0)
    table.Build()
    if array:
        mapper.SetScalarModeToUseCellFieldData()
        mapper.SelectColorArray(array)
        mapper.SetLookupTable(table)
        mapper.UseLookupTableScalarRangeOn()
    else:
        mapper.ScalarVisibilityOff()
    a = vtk.vtkActor()
    a.SetMapper(mapper)
    a.GetProperty().SetColor(0.98, 0.82, 0.25)
    a.GetProperty().SetEdgeVisibility(edges)
    a.GetProperty().SetEdgeColor(0.25, 0.22, 0.18)
    a.GetProperty().SetLineWidth(0.6)
    a.GetProperty().SetOpacity(opacity)
    return a


def main():
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("mesh")
    ap.add_argument("picture")
    ap.add_argument("--up", choices="xyz", default="y")
    ap.add_argument("--cut", choices="xyz", default="z")
    a = ap.parse_args()
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(a.mesh)
    reader.Update()
    mesh = reader.GetOutput()
    if mesh.GetNumberOfCells() == 0:
        raise SystemExit(f"{a.mesh}: no cells")
    center, size = mesh.GetCenter(), mesh.GetLength()
    up, cut = AXES[a.up], AXES[a.cut]

    plane = vtk.vtkPlane()
    plane.SetOrigin(center)
    plane.SetNormal([-c for c in cut])
    behind = vtk.vtkExtractGeometry()  # whole tets, not clipped ones: the cut shows their shapes
    behind.SetInputConnection(reader.GetOutputPort())
    behind.SetImplicitFunction(plane)
    behind.ExtractInsideOff()
    skin = vtk.vtkDataSetSurfaceFilter()
    skin.SetInputConnection(reader.GetOutputPort())

    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(1700, 700)
    left, right = view((0, 0, 0.5, 1), up, cut, center, size), view((0.5, 0, 1, 1), up, cut, center, size)
    left.AddActor(actor(skin.GetOutputPort(), 1, None))
    right.AddActor(actor(behind.GetOutputPort(), 1, "mean_ratio"))
    for r in (left, right):
        r.ResetCameraClippingRange()
        window.AddRenderer(r)
    window.Render()
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(a.picture)
    writer.SetInputConnection(grab.GetOutputPort())
    writer.Write()
    if writer.GetErrorCode():
        raise SystemExit(f"{a.picture}: could not be written")


if __name__ == "__main__":
    main()
