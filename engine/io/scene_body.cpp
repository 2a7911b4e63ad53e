#include "supple/io/mesh_file.h"
#include "supple/io/mesh_units.h"
#include "supple/io/scene_parts.h"
#include "supple/io/skin_file.h"
#include "supple/mesh/box_mesh.h"
#include "supple/mesh/refine.h"

namespace supple::io {

namespace {

constexpr double kMostCells = 2e7;

/// Runs `make`, putting the place in the scene before the message of what went wrong in a mesh.
template <class Make>
auto at_pointer(const JsonNode& node, Make&& make) {
    try {
        return make();
    } catch (const Error& error) {
        throw Error(error.code(), node.where(), error.what());
    }
}

VolumeMesh read_generated_box(const JsonNode& node) {
    node.require_object({"min_m", "max_m", "cells", "elements"});
    BoxDef def;
    const InsideBox corners = read_box(node, false);
    def.min_m = corners.min_m;
    def.max_m = corners.max_m;
    const JsonNode cells = node.at("cells", "give how many cells lie along x, y and z, e.g. [16, 4, 4]");
    if (!cells.is_array() || cells.size() != 3) cells.fail("must be a list of three whole numbers, found " + cells.shown());
    double total = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        def.cells[axis] = int(cells.item(axis).integer(1, 1000000));
        total *= def.cells[axis];
    }
    if (total > kMostCells) cells.fail(cells.shown() + " makes " + to_text(total) + " cells, more than " + to_text(kMostCells));
    const bool hexes = node.has("elements") && node.at("elements").choice({"tets", "hexes"}) == "hexes";
    return at_pointer(node, [&] { return hexes ? make_hex_box(def) : make_tet_box(def); });
}

/// Refinement needs elements that are wound well; a mesh that is not refined keeps its faults for the report of its template.
VolumeMesh refine_repaired(VolumeMesh mesh, int times) {
    if (times == 0) return mesh;
    check_and_repair(mesh);
    return refine(mesh, times);
}

std::shared_ptr<const BodyTemplate> read_shape(const JsonNode& node, double scale, SceneContext& context) {
    const int refined = (node.has("refine") ? int(node.at("refine").integer(0, 10)) : 0) + context.refine;
    if (node.has("mesh") && node.has("box")) node.at("box").fail("a body has a \"mesh\" or a \"box\", not both; remove one");
    const std::string unit = node.has("units") ? node.at("units").choice({"m", "dm", "cm", "mm", "um", "km", "in", "ft"}) : "m";
    const std::string up = node.has("up") ? node.at("up").choice({"y", "z", "x", "-y", "-z", "-x"}) : "y";
    if (node.has("box")) {
        for (const char* key : {"units", "up"})
            if (node.has(key)) node.at(key).fail("a generated box is in metres and has no file to convert; remove this key");
        const JsonNode box = node.at("box");
        VolumeMesh mesh = read_generated_box(box);
        if (refined > 0) mesh = at_pointer(box, [&] { return refine(mesh, refined); });
        return at_pointer(box, [&] { return BodyTemplate::build(std::move(mesh), scale); });
    }
    const JsonNode path = node.at("mesh", "give \"mesh\": \"file\" or \"box\": {\"min_m\", \"max_m\", \"cells\"}");
    const std::filesystem::path file = context.folder / path.text();
    if (path.text().empty()) path.fail("the path is empty; name a mesh file, relative to the scene file");
    const double metres = MeshUnits{scale, unit}.meters();
    auto& shape = context.shapes[{file.lexically_normal().string() + "^" + std::to_string(refined), up, metres}];
    if (shape) return shape;
    VolumeMesh mesh = at_pointer(path, [&] { return refine_repaired(read_mesh(file), refined); });
    MeshUnits{1, "m", up}.apply(mesh.vertices);
    shape = at_pointer(path, [&] { return BodyTemplate::build(std::move(mesh), metres); });
    return shape;
}

std::shared_ptr<const Skin> read_skin(const JsonNode& body, double scale, const BodyTemplate& shape, SceneContext& context) {
    const JsonNode node = body.at("skin");
    if (node.text().empty()) node.fail("the path is empty; name a surface file, relative to the scene file");
    const std::filesystem::path file = context.folder / node.text();
    auto& skin = context.skins[{file.lexically_normal().string(), &shape}];
    if (skin) return skin;
    mesh::TriangleMesh surface = at_pointer(node, [&] { return read_skin_surface(file); });
    const std::string unit = body.has("units") ? std::string(body.at("units").text()) : "m", up = body.has("up") ? std::string(body.at("up").text()) : "y";
    MeshUnits{scale, unit, up}.apply(surface.vertices);
    skin = at_pointer(node, [&] { return Skin::build(shape.mesh(), surface); });
    return skin;
}

/// Three numbers from 0 to 1.
std::array<float, 3> read_color(const JsonNode& node) {
    if (!node.is_array() || node.size() != 3) node.fail("must be a list of three numbers from 0 to 1: red, green, blue; found " + node.shown());
    std::array<float, 3> out{};
    for (std::size_t k = 0; k < 3; ++k) out[k] = float(node.item(k).number(0, 1));
    return out;
}

}  // namespace

InsideBox read_box(const JsonNode& node, bool may_be_flat) {
    const InsideBox box{node.at("min_m").vec3(), node.at("max_m").vec3()};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double low = box.min_m[Eigen::Index(axis)], high = box.max_m[Eigen::Index(axis)];
        if (low < high || (may_be_flat && low == high)) continue;
        node.at("max_m").item(axis).fail(to_text(high) + " is not above min_m (" + to_text(low) + ") in " + "xyz"[axis] +
                                         "; exchange or correct them");
    }
    return box;
}

SceneBody read_body(const JsonNode& node, SceneContext& context) {
    node.require_object({"name", "mesh", "box", "scale", "units", "up", "color", "inner_color", "translation_m", "velocity_m_s", "density_kg_m3", "material", "skin", "refine", "regions", "fixed",
                         "prescribed", "loads", "probes", "touches_bodies", "touches_itself", "friction"});
    SceneBody body;
    BodyDef& def = body.def;
    if (node.has("name")) def.name = node.at("name").text();
    const double scale = node.has("scale") ? node.at("scale").number_above(0, 1e9) : 1.0;
    def.shape = read_shape(node, scale, context);
    if (node.has("skin")) def.skin = read_skin(node, scale, *def.shape, context);
    if (node.has("translation_m")) def.translation_m = node.at("translation_m").vec3(1e9);
    if (node.has("velocity_m_s")) def.velocity_m_s = node.at("velocity_m_s").vec3(1e9);
    if (node.has("density_kg_m3")) def.density_kg_m3 = node.at("density_kg_m3").number_above(0, 1e9);
    if (node.has("touches_bodies")) def.touches_bodies = node.at("touches_bodies").boolean();
    if (node.has("touches_itself")) def.touches_itself = node.at("touches_itself").boolean();
    if (node.has("friction")) def.friction = node.at("friction").number(0, 10);
    if (node.has("color")) body.color = read_color(node.at("color"));
    if (node.has("inner_color")) body.inner_color = read_color(node.at("inner_color"));
    read_materials(node, def);
    read_supports_and_loads(node, body);
    read_probes(node, body);
    return body;
}

}  // namespace supple::io
