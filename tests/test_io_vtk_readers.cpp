// The readers that ParaView has (VTK's own, through Python) are asked about every file of ours that they can read.
#include "supple/io/binary_file.h"
#include "supple/io/mesh_file.h"
#include "supple/io/mesh_formats.h"
#include "supple/io/result_export.h"
#include "supple/io/surface_file.h"
#include "supple/mesh/box_mesh.h"
#include "supple/mesh/surface.h"
#include "supple/world/world.h"
#include "test_io_helpers.h"

namespace supple::io {
namespace {

/// Tets and a hex, two regions, a vertex of no element, coordinates of many digits.
VolumeMesh mixed_mesh() {
    VolumeMesh mesh = make_tet_box({.max_m = {0.1, 1.0 / 3, 3e-5}, .cells = {3, 2, 1}});
    mesh.vertices.push_back({5, 1e-17, -5});
    const auto first = std::int32_t(mesh.vertices.size());
    for (int i = 0; i < 8; ++i) mesh.vertices.push_back({double(i == 1 || i == 2 || i == 5 || i == 6), double(i == 2 || i == 3 || i == 6 || i == 7), 4.0 + (i > 3)});
    mesh.hexes = {{first, first + 1, first + 2, first + 3, first + 4, first + 5, first + 6, first + 7}};
    mesh.regions = {{"soft", 3}, {"hard", 8}};
    mesh.element_region.assign(mesh.element_count(), 0);
    mesh.element_region.back() = 1;
    return mesh;
}

std::string python_points(const std::vector<Vec3>& points) {
    std::string out = "np.array([";
    for (const Vec3& x : points) out += "[" + to_text(x.x()) + "," + to_text(x.y()) + "," + to_text(x.z()) + "],";
    return out + "])\n";
}

template <class Items>
std::string python_ids(const Items& items) {
    std::string out = "np.array([";
    for (const auto& item : items) {
        out += "[";
        for (const std::int32_t v : item) out += std::to_string(v) + ",";
        out += "],";
    }
    return out + "])\n";
}

const char* const kHead = R"(import sys
import numpy as np
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
from vtkmodules.vtkIOLegacy import vtkUnstructuredGridReader
from vtkmodules.vtkIOPLY import vtkPLYReader
from vtkmodules.vtkIOGeometry import vtkOBJReader, vtkSTLReader, vtkGLTFReader
from vtkmodules.util.numpy_support import vtk_to_numpy
failed = 0
def grid_of(name):
    r = vtkXMLUnstructuredGridReader() if name.endswith('.vtu') else vtkUnstructuredGridReader()
    errors = []
    r.AddObserver('ErrorEvent', lambda *a: errors.append(a))
    r.SetFileName(name)
    if not name.endswith('.vtu'):
        r.ReadAllScalarsOn()
    r.Update()
    assert not errors, 'VTK reports an error'
    return r.GetOutput()
def cells_of(g, kind):
    types = vtk_to_numpy(g.GetCellTypesArray())
    return np.array([[g.GetCell(i).GetPointId(k) for k in range(g.GetCell(i).GetNumberOfPoints())] for i in np.nonzero(types == kind)[0]])
def check(name, test):
    global failed
    try:
        test(name)
    except BaseException as e:
        print(name, 'FAILED', repr(e))
        failed = 1
)";

int run_python(const std::string& python, const test::TemporaryFolder& folder, const std::string& program) {
    write_text_file(folder / "check.py", program + "sys.exit(failed)\n");
    return std::system((python + " " + (folder / "check.py").string()).c_str());
}

TEST(IoVtkReaders, ReadEveryVolumeFormatThatTheyKnow) {
    std::string python;
    if (!test::python_with("vtkmodules", python)) return;
    const test::TemporaryFolder folder;
    const VolumeMesh mesh = mixed_mesh();
    std::string program = kHead;
    program += "points = " + python_points(mesh.vertices) + "tets = " + python_ids(mesh.tets) + "hexes = " + python_ids(mesh.hexes);
    program += "def same(name):\n"
               "    g = grid_of(name)\n"
               "    assert np.array_equal(vtk_to_numpy(g.GetPoints().GetData()), points), 'points'\n"
               "    assert np.array_equal(cells_of(g, 10), tets), 'tets'\n"
               "    assert np.array_equal(cells_of(g, 12), hexes), 'hexes'\n"
               "    assert np.array_equal(vtk_to_numpy(g.GetCellData().GetArray('region')), [3] * len(tets) + [8]), 'regions'\n";
    std::size_t checked = 0;
    for (const OutputFormat& format : output_formats()) {
        if (!format.write || format.key.substr(0, 2) != "vt") continue;
        const std::string name = std::string(format.key) + std::string(format.endings);
        write_mesh(folder / name, mesh, format.key);
        program += "check('" + (folder / name).string() + "', same)\n";
        ++checked;
    }
    EXPECT_EQ(checked, 8u);
    EXPECT_EQ(run_python(python, folder, program), 0);
}

TEST(IoVtkReaders, ReadEverySurfaceFormatThatTheyKnow) {
    std::string python;
    if (!test::python_with("vtkmodules", python)) return;
    const test::TemporaryFolder folder;
    const VolumeMesh box = make_hex_box({.max_m = {1, 0.5, 0.25}, .cells = {4, 2, 1}});
    const mesh::TriangleMesh surface{box.vertices, extract_boundary(box).triangles};
    std::string program = kHead;
    program += "corners = " + python_points(surface.vertices) + "triangles = " + python_ids(surface.triangles);
    program += "def same(name):\n"
               "    r = {'obj': vtkOBJReader, 'stl': vtkSTLReader, 'ply': vtkPLYReader}[name[-3:]]()\n"
               "    r.SetFileName(name)\n"
               "    r.Update()\n"
               "    s = r.GetOutput()\n"
               "    p = vtk_to_numpy(s.GetPoints().GetData()).astype(float)\n"
               "    t = vtk_to_numpy(s.GetPolys().GetConnectivityArray()).reshape(-1, 3)\n"
               "    assert np.allclose(p[t], corners[triangles], atol=1e-6), 'triangles'\n";
    std::size_t checked = 0;
    for (const OutputFormat& format : output_formats()) {
        if (!format.write_surface || format.key == "off") continue;  // VTK 9.1 has no reader of OFF
        const std::string name = std::string(format.key) + std::string(format.endings);
        write_surface(folder / name, surface, format.key);
        program += "check('" + (folder / name).string() + "', same)\n";
        ++checked;
    }
    EXPECT_EQ(checked, 5u);
    EXPECT_EQ(run_python(python, folder, program), 0);
}

TEST(IoVtkReaders, ReadTheResultsOfARun) {
    std::string python;
    if (!test::python_with("vtkmodules", python)) return;
    const test::TemporaryFolder folder;
    World world({.time_step_s = 0.02, .threads = 1});
    BodyDef def;
    def.name = "bar";
    def.shape = BodyTemplate::build(make_tet_box({.max_m = {0.4, 0.1, 0.1}, .cells = {4, 1, 1}}));
    def.material = Corotational{.young_pa = 3e3, .poisson = 0.4};
    const BodyId bar = world.add_body(def);
    world.fix(bar, InsideBox{{-1, -1, -1}, {1e-6, 1, 1}});
    const auto series = ResultExport::open(folder / "series", world, false);
    const auto animation = ResultExport::open(folder / "a.glb", world, false);
    for (int i = 0; i < 3; ++i) {
        world.step();
        series->add_frame(world);
        animation->add_frame(world);
    }
    series->finish();
    animation->finish();
    std::string program = kHead;
    program += "import os, re\npositions = " + python_points({world.positions(bar).begin(), world.positions(bar).end()});
    program += "mises = np.array([";
    for (const double s : world.von_mises(bar)) program += to_text(s) + ",";
    program += "])\n"
               "def results(name):\n"
               "    files = re.findall('file=\"([^\"]+)\"', open(name).read())\n"
               "    assert len(files) == 3, files\n"
               "    g = grid_of(os.path.join(os.path.dirname(name), files[-1]))\n"
               "    assert np.array_equal(vtk_to_numpy(g.GetPoints().GetData()), positions), 'positions'\n"
               "    assert np.allclose(vtk_to_numpy(g.GetPointData().GetArray('von_mises_pa')), mises, rtol=1e-6), 'von Mises'\n"
               "    assert vtk_to_numpy(g.GetPointData().GetArray('stress_pa')).shape == (len(positions), 6), 'stress'\n"
               "check('" + (folder / "series/results.pvd").string() + "', results)\n"
               "def scene(name):\n"
               "    r = vtkGLTFReader()\n"
               "    r.SetFileName(name)\n"
               "    r.Update()\n"
               "    assert r.GetNumberOfAnimations() == 1, 'animations'\n"
               "    assert r.GetOutput().GetNumberOfPoints() > 0, 'points'\n"
               "check('" + (folder / "a.glb").string() + "', scene)\n";
    EXPECT_EQ(run_python(python, folder, program), 0);
}

}  // namespace
}  // namespace supple::io
