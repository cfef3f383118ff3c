#!/usr/bin/python3
# %% [markdown]
# # A gyroid in a ball, from numpy to a finite element mesh
#
# Cells of a notebook, as Jupyter, VS Code and Spyder read them; also a script: `PYTHONPATH=build/release/python
# /usr/bin/python3 examples/python/gyroid.py [FOLDER]` writes gyroid.vtu, gyroid.msh and, where python3-vtk9 is,
# gyroid.png, the picture of python/README.md.

# %%
import sys
from pathlib import Path

import numpy as np
import umtet

folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")

# %% [markdown]
# psi < 0 inside: a sheet about the gyroid, cut by a ball. It takes points (n, 3) and gives values (n,); gradients are
# made of differences. Where two surfaces meet, a smooth maximum rounds the edge, as psi is to be C2.

# %%
PERIOD, HALF_THICKNESS, ROUNDING = 1.2, .08, .05


def smooth_maximum(a, b):
    return ROUNDING * np.logaddexp(a / ROUNDING, b / ROUNDING)


def psi(x):
    k = 2 * np.pi / PERIOD
    s, c = np.sin(k * x).T, np.cos(k * x).T
    gyroid = (s[0] * c[1] + s[1] * c[2] + s[2] * c[0]) / (1.5 * k)  # about a distance near its zero
    sheet = smooth_maximum(gyroid - HALF_THICKNESS, -gyroid - HALF_THICKNESS)
    return smooth_maximum(sheet, np.linalg.norm(x, axis=1) - 1)


# %% [markdown]
# The mesh comes with a certificate: what was measured of it, and whether its boundary is that of {psi < 0}.

# %%
mesh = umtet.mesh(psi, box=(-1.3, -1.3, -1.3, 1.3, 1.3, 1.3), h=.05)
c = mesh.certificate
print(mesh)
print("certified:", mesh.certified, "| genus:", c["boundary"]["genus"], "| volume:", round(c["volume"], 4),
      "| least mean ratio:", round(c["quality"]["min"], 3))

# %% [markdown]
# For solvers: files, or the arrays as they are (`mesh.points`, `mesh.tets`, `mesh.patches()`), or `mesh.to_meshio()`.

# %%
mesh.save(folder / "gyroid.vtu")
mesh.save(folder / "gyroid.msh")

# %% [markdown]
# A picture: `mesh.to_pyvista().plot(show_edges=True)` with pyvista; here with VTK alone.


# %%
def picture(path):
    import vtk
    skin, mapper, actor, renderer, window = (vtk.vtkDataSetSurfaceFilter(), vtk.vtkPolyDataMapper(), vtk.vtkActor(),
                                             vtk.vtkRenderer(), vtk.vtkRenderWindow())
    skin.SetInputData(mesh.to_vtk())
    mapper.SetInputConnection(skin.GetOutputPort())
    mapper.ScalarVisibilityOff()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(.36, .62, .78)
    actor.GetProperty().EdgeVisibilityOn()
    actor.GetProperty().SetEdgeColor(.15, .2, .25)
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor(actor)
    renderer.GetActiveCamera().SetPosition(2.4, 1.7, 1.9)
    renderer.ResetCamera()
    renderer.GetActiveCamera().Zoom(1.5)
    window.SetOffScreenRendering(1)
    window.SetSize(700, 700)
    window.SetMultiSamples(8)
    window.AddRenderer(renderer)
    window.Render()
    grab, writer = vtk.vtkWindowToImageFilter(), vtk.vtkPNGWriter()
    grab.SetInput(window)
    writer.SetInputConnection(grab.GetOutputPort())
    writer.SetFileName(str(path))
    writer.Write()


if __name__ == "__main__":
    try:
        picture(folder / "gyroid.png")
    except ImportError:
        print("no python3-vtk9: no picture")
