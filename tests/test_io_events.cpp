// "events" of scene files.
#include <gtest/gtest.h>

#include "mesh_helpers.h"
#include "supple/io/scene.h"
#include "supple/mesh/surface.h"

namespace supple {
namespace {

io::Scene parse(const std::string& events) {
    return io::parse_scene(R"({"supple_scene": 1, "time_step_s": 0.01, "gravity_m_s2": [0, 0, 0], "threads": 1, "bodies": [
        {"name": "bar", "box": {"min_m": [0, 0, 0], "max_m": [0.4, 0.1, 0.1], "cells": [8, 2, 2], "elements": "tets"}, "density_kg_m3": 1000,
         "material": {"law": "corotational", "young_pa": 1e5, "poisson": 0.3}}], "events": )" + events + "}", ".", "scene");
}

TEST(IoEvents, CutsAndErasuresHappenWhenTheFileSays) {
    const io::Scene scene = parse(R"([{"cut": {"body": "bar", "from_m": [[0.213, 0.2, -1], [0.213, 0.2, 1]], "to_m": [[0.213, -0.2, -1], [0.213, -0.2, 1]], "times_s": [0.02, 0.08]}},
                                      {"erase": {"from_m": [0.4, 0.05, 0.05], "radius_m": 0.05, "times_s": 0.11}}])");
    World world = io::build_world(scene);
    const EditScript script = io::make_edits(scene, world);
    const BodyId body = world.bodies()[0];
    for (int i = 0; i < 10; ++i) {
        script.before_step(world);
        world.step();
        EXPECT_EQ(world.pieces(body).size(), i < 2 ? 1u : world.pieces(body).size());
    }
    EXPECT_EQ(world.pieces(body).size(), 2u);
    const std::size_t before = world.shape(body).mesh().element_count();
    for (int i = 0; i < 3; ++i) {
        script.before_step(world);
        world.step();
    }
    EXPECT_LT(world.shape(body).mesh().element_count(), before);
}

TEST(IoEvents, ElementsAreAddedWhenTheFileSays) {
    const io::Scene scene = parse(R"([{"add": {"body": "bar", "vertices_m": [[0.45, 0.03, 0.02]], "tets": [[8, 17, 35, 81]], "source": 0, "time_s": 0.03}}])");
    World world = io::build_world(scene);
    const BodyId body = world.bodies()[0];
    // Of whatever numbering: a tet on a boundary face near the end.
    const VolumeMesh& mesh = world.shape(body).mesh();
    const BoundarySurface boundary = extract_boundary(mesh);
    std::size_t face = 0;
    while (mesh.vertices[std::size_t(boundary.triangles[face][0])].x() < 0.399 || mesh.vertices[std::size_t(boundary.triangles[face][1])].x() < 0.399 || mesh.vertices[std::size_t(boundary.triangles[face][2])].x() < 0.399) ++face;
    const Triangle& t = boundary.triangles[face];
    const std::string corners = std::to_string(t[0]) + ", " + std::to_string(t[1]) + ", " + std::to_string(t[2]) + ", " + std::to_string(mesh.vertices.size());
    const io::Scene fitting = parse(R"([{"add": {"body": "bar", "vertices_m": [[0.45, 0.05, 0.05]], "tets": [[)" + corners + R"(]], "source": )" + std::to_string(boundary.element[face]) + R"(, "time_s": 0.03}}])");
    const std::size_t before = mesh.element_count(), vertices = mesh.vertices.size();
    const EditScript script = io::make_edits(fitting, world);
    for (int i = 0; i < 6; ++i) {
        EXPECT_EQ(script.before_step(world), i == 3 ? 1u : 0u);
        EXPECT_EQ(world.step().flags, StepFlag::none);
    }
    EXPECT_EQ(world.shape(body).mesh().element_count(), before + 1);
    EXPECT_EQ(world.masses(body).size(), vertices + 1);
    using supple_test::expect_error;
    expect_error(ErrorCode::parse, "the 4 vertices of an element", [] { parse(R"([{"add": {"tets": [[0, 1, 2]], "source": 0, "time_s": 0}}])"); });
    expect_error(ErrorCode::parse, "needs tets or hexes", [] { parse(R"([{"add": {"source": 0, "time_s": 0}}])"); });
    World other = io::build_world(scene);
    const EditScript overlapping = io::make_edits(parse(R"([{"add": {"tets": [[0, 1, 2, 99999]], "source": 0, "time_s": 0}}])"), other);
    expect_error(ErrorCode::invalid_argument, "add_elements", [&] { overlapping.before_step(other); });
}

TEST(IoEvents, ACutIsHealedWhenTheFileSays) {
    const io::Scene scene = parse(R"([{"cut": {"from_m": [[0.213, 0.2, -1], [0.213, 0.2, 1]], "to_m": [[0.213, -0.2, -1], [0.213, -0.2, 1]], "times_s": 0.02}},
                                      {"heal": {"body": "bar", "gap_m": 0.01, "centre_m": [0.2, 0.05, 0.05], "radius_m": 0.2, "time_s": 0.05}}])");
    World world = io::build_world(scene);
    const EditScript script = io::make_edits(scene, world);
    for (int i = 0; i < 8; ++i) {
        script.before_step(world);
        world.step();
        EXPECT_EQ(world.pieces(world.bodies()[0]).size(), i < 2 || i >= 5 ? 1u : 2u) << "before step " << i;
    }
}

TEST(IoEvents, MistakesAreNamed) {
    const auto refused = [](const std::string& text, const std::string& events) { supple_test::expect_error(ErrorCode::parse, text, [&] { parse(events); }); };
    const std::string blade = R"("from_m": [[0, 0, 0], [1, 0, 0]], "to_m": [[0, 1, 0], [1, 1, 0]])";
    refused("either a \"cut\", an \"erase\", a \"heal\" or an \"add\"", "[{}]");
    refused("/events/0/heal", R"([{"heal": {"gap_m": 0.1}}])");
    refused("gap_m", R"([{"heal": {"gap_m": 0, "time_s": 1}}])");
    refused("both centre_m and radius_m", R"([{"heal": {"radius_m": 1, "time_s": 1}}])");
    refused("two points or more", R"([{"cut": {"from_m": [[0, 0, 0]], "to_m": [[0, 0, 0]], "times_s": 1}}])");
    refused("as many points", R"([{"cut": {"from_m": [[0, 0, 0], [1, 0, 0]], "to_m": [[0, 0, 0], [1, 0, 0], [2, 0, 0]], "times_s": 1}}])");
    refused("ends before it begins", "[{\"cut\": {" + blade + ", \"times_s\": [2, 1]}}]");
    refused("no name of a body", "[{\"cut\": {\"body\": \"baz\", " + blade + ", \"times_s\": 1}}]");
    refused("/events/0/erase", R"([{"erase": {"from_m": [0, 0, 0], "times_s": 1}}])");
    refused("radius_m", R"([{"erase": {"from_m": [0, 0, 0], "radius_m": 0, "times_s": 1}}])");
}

}  // namespace
}  // namespace supple
