// Pieces of bodies that edits part, and the faces that they lay open.
#include <Eigen/Geometry>
#include <numeric>

#include "support/bodies.h"
#include "support/edits.h"

namespace supple {
namespace {

using test::blade_at_x;

WorldDef plain_world() { return {.gravity_m_s2 = Vec3::Zero(), .time_step_s = 0.01, .threads = 2}; }

TEST(TopologyPieces, PiecesAreReportedAndSmallOnesRemoved) {
    World world(plain_world());
    const BodyId body = world.add_body({.shape = test::hex_bar({16, 4, 4}), .material = Corotational{}, .density_kg_m3 = 1000});
    world.fix(body, test::at_x(0.4));
    world.cut(body, blade_at_x(0.0251));
    world.cut(body, blade_at_x(0.2));
    const auto pieces = world.pieces(body);
    ASSERT_EQ(pieces.size(), 3u);
    EXPECT_NEAR(pieces[0].volume_m3, 0.025 * 0.01, 1e-12);
    EXPECT_NEAR(pieces[0].mass_kg, 0.25, 1e-12);
    EXPECT_FALSE(pieces[0].supported);
    EXPECT_TRUE(pieces[2].supported);
    EXPECT_EQ(world.remove_pieces(body, 0.001).removed_elements().size(), 16u);
    EXPECT_EQ(world.pieces(body).size(), 2u);
    EXPECT_EQ(world.split_off_pieces(body).size(), 1u);
    ASSERT_EQ(world.pieces(body).size(), 1u);
    EXPECT_TRUE(world.pieces(body)[0].supported);
    for (int i = 0; i < 5; ++i) EXPECT_EQ(world.step().flags, StepFlag::none);
}

TEST(TopologyPieces, OnlyPiecesBelowTheBoundAreRemovedAndNeverTheLargest) {
    const auto parted = [](World& world) {  // slabs of 1, 3, 4 and 8 layers of 16 hexes
        const BodyId body = world.add_body({.shape = test::hex_bar({16, 4, 4}), .material = Corotational{}, .density_kg_m3 = 1000});
        for (const int layers : {1, 4, 8}) world.cut(body, blade_at_x(0.025 * layers + 1e-4));
        EXPECT_EQ(world.pieces(body).size(), 4u);
        return body;
    };
    const double layer = 0.025 * 0.01;
    const auto left = [&](double below_m3) {
        World world(plain_world());
        const BodyId body = parted(world);
        const std::uint64_t edits = world.edit_count(body);
        const TopologyDelta delta = world.remove_pieces(body, below_m3);
        EXPECT_EQ(delta.is_identity(), world.edit_count(body) == edits);
        std::vector<std::size_t> out;
        double mass = 0;
        for (const Piece& piece : world.pieces(body)) {
            out.push_back(piece.elements.size() / 16);
            mass += piece.mass_kg;
        }
        const auto masses = world.masses(body);
        EXPECT_NEAR(mass, std::accumulate(masses.begin(), masses.end(), 0.0), 1e-9);
        if (!delta.is_identity()) {
            EXPECT_TRUE(world.undo_edit(body));
            EXPECT_EQ(world.pieces(body).size(), 4u);
        }
        return out;
    };
    using Layers = std::vector<std::size_t>;
    EXPECT_EQ(left(0), (Layers{1, 3, 4, 8}));
    EXPECT_EQ(left(layer * (1 - 1e-9)), (Layers{1, 3, 4, 8}));
    EXPECT_EQ(left(layer * (1 + 1e-9)), (Layers{3, 4, 8}));
    EXPECT_EQ(left(3 * layer * (1 - 1e-9)), (Layers{3, 4, 8}));
    EXPECT_EQ(left(4 * layer * (1 - 1e-9)), (Layers{4, 8}));
    EXPECT_EQ(left(4 * layer * (1 + 1e-9)), (Layers{8}));
    EXPECT_EQ(left(1), (Layers{8})) << "the largest stays";
    World world(plain_world());
    const BodyId body = parted(world);
    supple_test::expect_error(ErrorCode::invalid_argument, "remove_pieces", [&] { world.remove_pieces(body, -1); });
}

TEST(TopologyFaces, ItIsKnownWhichOnesEditsLaidOpen) {
    World world(plain_world());
    const BodyId body = world.add_body({.shape = test::bar(), .material = Corotational{}, .density_kg_m3 = 1000});
    EXPECT_TRUE(world.inner_boundary(body).empty());
    const auto laid_open = [&] {
        const std::vector<char> inner = world.inner_boundary(body);
        const BodyTemplate& shape = world.shape(body);
        EXPECT_EQ(inner.size(), shape.boundary().triangles.size());
        double area = 0;
        for (std::size_t t = 0; t < inner.size(); ++t) {
            const auto x = [&](std::size_t k) -> const Vec3& { return shape.mesh().vertices[std::size_t(shape.boundary().triangles[t][k])]; };
            if (inner[t]) area += 0.5 * (x(1) - x(0)).cross(x(2) - x(0)).norm();
        }
        return area;
    };
    world.cut(body, blade_at_x(0.11));
    EXPECT_NEAR(laid_open(), 2 * 0.01, 0.1 * 0.01) << "two lips; a cut near vertices goes through them";
    world.cut(body, blade_at_x(0.29));
    EXPECT_NEAR(laid_open(), 4 * 0.01, 0.2 * 0.01) << "those of earlier edits, too";
    const std::int32_t corner[] = {world.shape(body).boundary().element.front()};
    world.undo_edit(body);
    world.undo_edit(body);
    for (const char inner : world.inner_boundary(body)) EXPECT_EQ(inner, 0);
    world.remove_elements(body, corner);
    EXPECT_GT(laid_open(), 0);
    EXPECT_LT(laid_open(), 0.002);
}

}  // namespace
}  // namespace supple
