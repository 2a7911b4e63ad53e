#include "supple/io/mesh_file.h"

#include "supple/base/error.h"
#include "supple/io/binary_file.h"
#include "supple/io/gmsh.h"
#include "supple/io/medit.h"
#include "supple/io/mesh_format.h"
#include "supple/io/refusals.h"
#include "supple/io/vtk.h"

namespace supple::io {

Error surface_error(const std::string& where, const std::string& holds) {
    return Error(ErrorCode::surface_mesh, where,
                 "this is a surface mesh (" + holds +
                     ", no tetrahedra or hexahedra), but a volume mesh is needed; fill the closed surface with "
                     "tetrahedra first, e.g. with Gmsh, TetGen or fTetWild, and save it as Gmsh .msh");
}

VolumeMesh parse_mesh(std::string_view bytes, const std::string& name) {
    if (bytes.empty()) throw Error(ErrorCode::parse, name + ":1", "the file is empty");
    if (bytes.substr(0, 3) == "\xEF\xBB\xBF") bytes.remove_prefix(3);
    const MeshFormat format = detect_mesh_format(bytes, name);
    switch (format.kind) {
        case MeshFormat::Kind::gmsh:
            return parse_gmsh(bytes, name);
        case MeshFormat::Kind::medit:
            return parse_medit(bytes, name);
        case MeshFormat::Kind::vtk_legacy:
            return parse_vtk_legacy(bytes, name);
        case MeshFormat::Kind::vtk_xml:
            return parse_vtk_xml(bytes, name);
        case MeshFormat::Kind::volume:
            throw Error(ErrorCode::unsupported, name, "this is " + format.name + ", which is not read; " + format.advice);
        case MeshFormat::Kind::surface:
            throw surface_error(name, format.name);
        case MeshFormat::Kind::unknown:
            break;
    }
    throw Error(ErrorCode::unsupported, name + ":1",
                "the format is not recognised; readable are meshes of tetrahedra in Gmsh 1, 2.2 and 4.1, Medit, VTK legacy and VTU files, "
                "all as ASCII");
}

VolumeMesh read_mesh(const std::filesystem::path& file) { return parse_mesh(read_text_file(file), file.string()); }

void write_gmsh(const std::filesystem::path& file, const VolumeMesh& mesh) { write_text_file(file, format_gmsh(mesh)); }

}  // namespace supple::io
