#include <Eigen/Geometry>

#include "supple/contact/distance_grid.h"
#include "supple/io/mesh_file.h"
#include "supple/io/scene_parts.h"
#include "supple/io/surface_file.h"
#include "supple/io/text_scanner.h"
#include "supple/mesh/surface.h"

namespace supple::io {

namespace {

constexpr double kLargest_m = 1e6;

std::array<double, 4> read_rotation(const JsonNode& node) {
    if (!node.is_array() || node.size() != 4) node.fail("must be a quaternion [w, x, y, z], found " + node.shown());
    std::array<double, 4> q{};
    double square = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        q[i] = node.item(i).number(-1e6, 1e6);
        square += q[i] * q[i];
    }
    if (!(square > 1e-12)) node.fail("has no length; [1, 0, 0, 0] is no rotation");
    return q;
}

double size(const JsonNode& node, const char* key) { return node.at(key).number_above(0, kLargest_m); }

/// The surface of a mesh file: of a volume mesh its boundary.
mesh::TriangleMesh read_closed_surface(const std::filesystem::path& file) {
    try {
        VolumeMesh volume = read_mesh(file);
        check_and_repair(volume);
        return {volume.vertices, extract_boundary(volume).triangles};
    } catch (const Error& error) {
        if (error.code() != ErrorCode::surface_mesh && error.code() != ErrorCode::unsupported) throw;
    }
    return read_surface(file);
}

/// The inside of a mesh file.
MeshShape read_mesh_shape(const JsonNode& node, SceneContext& context) {
    node.require_object({"file", "scale", "cells"});
    const JsonNode path = node.at("file", "name a closed surface or a volume mesh, relative to the scene file");
    const double scale = node.has("scale") ? node.at("scale").number_above(0, 1e9) : 1.0;
    const int cells = node.has("cells") ? int(node.at("cells").integer(8, 256)) : 64;
    const std::filesystem::path file = context.folder / path.text();
    try {
        mesh::TriangleMesh surface = read_closed_surface(file);
        for (Vec3& x : surface.vertices) x *= scale;
        return {contact::DistanceGrid::build(surface.vertices, surface.triangles, file.filename().string(), cells)};
    } catch (const Error& error) {
        throw Error(error.code(), path.where(), error.what());
    }
}

/// The shape under `key`; where its entry says where it is (centre, corners), the pose too.
Shape read_shape(const JsonNode& node, std::string_view key, Pose& pose, SceneContext& context) {
    const JsonNode value = node.at(key);
    const auto place = [&](const Vec3& centre) {
        if (node.has("position_m")) node.at("position_m").fail("the " + std::string(key) + " says already where it is; keep one");
        pose.position_m = centre;
    };
    if (key == "plane") {
        value.require_object({"normal", "offset_m"});
        PlaneShape plane;
        if (value.has("normal")) plane.normal = value.at("normal").vec3(1e9);
        if (!(plane.normal.norm() > 1e-9)) value.at("normal").fail("has no length; give the direction that points out of the solid");
        if (value.has("offset_m")) plane.offset_m = value.at("offset_m").number(-1e9, 1e9);
        return plane;
    }
    if (key == "sphere") {
        value.require_object({"radius_m", "centre_m"});
        if (value.has("centre_m")) place(value.at("centre_m").vec3(1e9));
        return SphereShape{size(value, "radius_m")};
    }
    if (key == "capsule" || key == "cylinder") {
        value.require_object({"radius_m", "half_length_m"});
        if (key == "capsule") return CapsuleShape{size(value, "radius_m"), size(value, "half_length_m")};
        return CylinderShape{size(value, "radius_m"), size(value, "half_length_m")};
    }
    if (key == "box") {
        value.require_object({"half_extents_m", "min_m", "max_m"});
        if (value.has("half_extents_m")) {
            if (value.has("min_m") || value.has("max_m")) value.fail("has half_extents_m and corners; keep one");
            const Vec3 half = value.at("half_extents_m").vec3(kLargest_m);
            if (!(half.minCoeff() > 0)) value.at("half_extents_m").fail("must be three lengths above 0");
            return BoxShape{half};
        }
        const InsideBox corners = read_box(value, false);
        place(0.5 * (corners.min_m + corners.max_m));
        return BoxShape{0.5 * (corners.max_m - corners.min_m)};
    }
    return read_mesh_shape(value, context);
}

PoseKeys read_keys(const JsonNode& node) {
    node.require_object({"times_s", "positions_m", "rotations_wxyz"});
    PoseKeys keys;
    for (const JsonNode& time : node.at("times_s", "give the times of the keyframes").items()) {
        const double t = time.number();
        if (!keys.times_s.empty() && t <= keys.times_s.back()) time.fail(time.shown() + " s does not come after the time before it; times must ascend");
        keys.times_s.push_back(t);
    }
    if (keys.times_s.empty()) node.at("times_s").fail("is empty; give at least one time");
    if (!node.has("positions_m") && !node.has("rotations_wxyz")) node.fail("needs positions_m or rotations_wxyz, one per time");
    const auto count = [&](const JsonNode& list) {
        if (!list.is_array() || list.size() != keys.times_s.size()) {
            list.fail("must be a list of as many entries as times_s (" + std::to_string(keys.times_s.size()) + ")");
        }
        return list.items();
    };
    if (node.has("positions_m")) {
        for (const JsonNode& p : count(node.at("positions_m"))) keys.positions_m.push_back(p.vec3(1e9));
    }
    if (node.has("rotations_wxyz")) {
        for (const JsonNode& q : count(node.at("rotations_wxyz"))) keys.rotations_wxyz.push_back(read_rotation(q));
    }
    return keys;
}

ToolCoupling read_coupling(const JsonNode& node) {
    node.require_object({"stiffness_n_m", "damping_n_s_m", "max_force_n", "torsion_nm_rad", "max_torque_nm"});
    ToolCoupling coupling;
    if (node.has("stiffness_n_m")) coupling.stiffness_n_m = node.at("stiffness_n_m").number_above(0, 1e9);
    if (node.has("damping_n_s_m")) coupling.damping_n_s_m = node.at("damping_n_s_m").number(0, 1e9);
    if (node.has("max_force_n")) coupling.max_force_n = node.at("max_force_n").number(0, 1e9);
    if (node.has("torsion_nm_rad")) coupling.torsion_nm_rad = node.at("torsion_nm_rad").number(0, 1e9);
    if (node.has("max_torque_nm")) coupling.max_torque_nm = node.at("max_torque_nm").number(0, 1e9);
    return coupling;
}

}  // namespace

ColliderDef read_collider(const JsonNode& node, SceneContext& context) {
    static constexpr std::array<std::string_view, 6> kShapes = {"plane", "sphere", "capsule", "box", "cylinder", "mesh"};
    node.require_object({"plane", "sphere", "capsule", "box", "cylinder", "mesh", "name", "position_m", "rotation_wxyz", "friction", "motion", "tool", "mass_kg",
                         "velocity_m_s", "spin_rad_s"});
    ColliderDef def;
    std::string_view shape;
    for (const std::string_view key : kShapes) {
        if (!node.has(key)) continue;
        if (!shape.empty()) node.at(key).fail(quoted(key) + " and " + quoted(shape) + " exclude each other; keep one");
        shape = key;
    }
    if (shape.empty()) node.fail("has no shape; give one of plane, sphere, capsule, box, cylinder and mesh");
    def.shape = read_shape(node, shape, def.pose, context);
    if (node.has("name")) def.name = node.at("name").text();
    if (node.has("position_m")) def.pose.position_m = node.at("position_m").vec3(1e9);
    if (node.has("rotation_wxyz")) def.pose.rotation_wxyz = read_rotation(node.at("rotation_wxyz"));
    if (node.has("friction")) def.friction = node.at("friction").number(0, 10);
    if (node.has("motion")) {
        def.keys = read_keys(node.at("motion"));
        def.motion = ColliderMotion::kinematic;
    }
    if (node.has("mass_kg")) {
        if (shape == "plane") node.at("mass_kg").fail("a plane has no mass; give it a \"motion\" or leave it fixed");
        def.mass_kg = node.at("mass_kg").number_above(0, 1e9);
        def.motion = ColliderMotion::dynamic;
    }
    if (node.has("tool")) {
        if (!node.has("mass_kg")) node.at("tool").fail("a tool has a \"mass_kg\" beside it");
        def.coupling = read_coupling(node.at("tool"));
        def.motion = ColliderMotion::tool;
    } else if (node.has("motion") && node.has("mass_kg")) {
        node.at("mass_kg").fail("what follows keyframes exactly has no mass; add \"tool\" to have it drawn along them, or remove one");
    }
    for (const char* key : {"velocity_m_s", "spin_rad_s"}) {
        if (!node.has(key)) continue;
        if (def.mass_kg == 0) node.at(key).fail("only colliders with a mass_kg have a velocity of their own; give \"motion\"");
        (std::string_view(key) == "velocity_m_s" ? def.velocity_m_s : def.spin_rad_s) = node.at(key).vec3(1e6);
    }
    return def;
}

}  // namespace supple::io
