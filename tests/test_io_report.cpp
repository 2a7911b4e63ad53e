#include <limits>
#include <nlohmann/json.hpp>

#include "supple/io/binary_file.h"
#include "supple/io/report.h"
#include "supple/mesh/box_mesh.h"
#include "test_io_helpers.h"

namespace supple::io {
namespace {

RunSummary example_summary() {
    RunSummary summary;
    summary.time_step_s = 0.01;
    summary.threads = 2;
    summary.isa = "avx2";
    summary.precision = "single";
    summary.vertices = 12;
    summary.elements = 34;
    summary.bodies = 1;
    summary.state_hash = 0x00ab00000000cdefull;
    summary.energy = {1.5, 2.5, -3.5};
    summary.reaction_n = Vec3(0, 9.81, 0);
    summary.contact_force_n = Vec3(0.5, 4.5, 0);
    return summary;
}

StepReport step(double ms, int iterations, double residual, StepFlag flags = StepFlag::none) {
    StepReport report;
    report.step_ms = ms;
    report.cg_iterations = iterations;
    report.cg_relative_residual = residual;
    report.flags = flags;
    for (std::size_t s = 0; s < kStageCount; ++s) report.stage_ms[s] = ms * double(s);
    return report;
}

TEST(IoReport, OrderStatistics) {
    EXPECT_EQ(median({}), 0);
    EXPECT_EQ(median({3}), 3);
    EXPECT_EQ(median({3, 1, 2}), 2);
    EXPECT_EQ(median({4, 1, 3, 2}), 2.5);
    std::vector<double> thousand;
    for (int i = 1; i <= 1000; ++i) thousand.push_back((i * 3) % 1001);  // 1..1000 in another order
    EXPECT_EQ(percentile(thousand, 0.99), 990);
    EXPECT_EQ(percentile(thousand, 0.999), 999);
    EXPECT_EQ(percentile(thousand, 1), 1000);
    EXPECT_EQ(percentile({5, 6}, 0.99), 6);
    EXPECT_EQ(percentile({5}, 0.001), 5);
    EXPECT_EQ(percentile({}, 0.5), 0);
}

TEST(IoReport, HoldsEveryFieldOfTheFormat) {
    RunReport report;
    for (int i = 1; i <= 1000; ++i)
        report.add(step(i, i % 5, 1e-6 * i, i == 500 ? StepFlag::iteration_cap : i == 700 ? StepFlag::newton_cap : StepFlag::none));
    const test::TemporaryFolder folder;
    report.write(folder / "r.json", example_summary());
    const auto json = nlohmann::json::parse(read_text_file(folder / "r.json"));
    EXPECT_EQ(json["steps"], 1000);
    EXPECT_EQ(json["time_step_s"], 0.01);
    EXPECT_EQ(json["threads"], 2);
    EXPECT_EQ(json["isa"], "avx2");
    EXPECT_EQ(json["precision"], "single");
    EXPECT_EQ(json["vertices"], 12);
    EXPECT_EQ(json["elements"], 34);
    EXPECT_EQ(json["step_ms"]["median"], 500.5);
    EXPECT_EQ(json["step_ms"]["p99"], 990);
    EXPECT_EQ(json["step_ms"]["p999"], 999);
    EXPECT_EQ(json["step_ms"]["max"], 1000);
    ASSERT_EQ(json["stages_ms"].size(), kStageCount);
    EXPECT_EQ(json["stages_ms"][std::string(name(Stage::elements))], 500.5 * double(Stage::elements));
    EXPECT_EQ(json["cg_iterations"]["mean"], 2.0);
    EXPECT_EQ(json["cg_iterations"]["max"], 4);
    EXPECT_DOUBLE_EQ(json["cg_relative_residual"]["median"].get<double>(), 500.5e-6);
    EXPECT_DOUBLE_EQ(json["cg_relative_residual"]["max"].get<double>(), 1e-3);
    EXPECT_EQ(json["flags"], nlohmann::json::array({"iteration_cap", "newton_cap"}));
    EXPECT_EQ(json["state_hash"], "00ab00000000cdef");
    EXPECT_EQ(json["energy_j"]["kinetic"], 1.5);
    EXPECT_EQ(json["energy_j"]["elastic"], 2.5);
    EXPECT_EQ(json["energy_j"]["gravity"], -3.5);
    EXPECT_EQ(json["reaction_n"], nlohmann::json::array({0.0, 9.81, 0.0}));
    EXPECT_EQ(json["contact_force_n"], nlohmann::json::array({0.5, 4.5, 0.0}));
}

TEST(IoReport, IsValidWithoutStepsAndWithNonFiniteOnes) {
    RunReport report;
    const auto empty = nlohmann::json::parse(report.to_json(example_summary()));
    EXPECT_EQ(empty["steps"], 0);
    EXPECT_EQ(empty["step_ms"]["median"], 0);
    EXPECT_EQ(empty["cg_iterations"]["mean"], 0);
    EXPECT_EQ(empty["flags"], nlohmann::json::array());
    report.add(step(1, 1, std::numeric_limits<double>::quiet_NaN(), StepFlag::non_finite));
    report.add(step(1, 1, 1e-6));
    report.add(step(1, 1, 1e-6));
    const auto bad = nlohmann::json::parse(report.to_json(example_summary()));
    EXPECT_TRUE(bad["cg_relative_residual"]["max"].is_number());
    EXPECT_GT(bad["cg_relative_residual"]["max"].get<double>(), 1e300);
    EXPECT_EQ(bad["cg_relative_residual"]["median"], 1e-6);
    EXPECT_EQ(bad["flags"], nlohmann::json::array({"non_finite"}));
    EXPECT_EQ(report.flags(), StepFlag::non_finite);
}

TEST(IoReport, SummarisesAWorld) {
    WorldDef def;
    def.time_step_s = 0.01;
    def.threads = 1;
    def.solver.precision = Precision::double_;
    World world(def);
    const auto shape = BodyTemplate::build(make_tet_box({Vec3(0, 0, 0), Vec3(1, 1, 1), {2, 2, 2}}));
    BodyDef body;
    body.shape = shape;
    world.add_body(body);
    body.density_kg_m3 = 10;
    const BodyId a = world.add_body(body);
    world.fix(a, Everything{});
    RunReport report;
    for (int i = 0; i < 3; ++i) report.add(world.step());
    const RunSummary summary = summarise(world, "scalar", 1);
    EXPECT_EQ(summary.vertices, 54u);
    EXPECT_EQ(summary.elements, 96u);
    EXPECT_EQ(summary.bodies, 2u);
    EXPECT_EQ(summary.precision, "double");
    EXPECT_EQ(summary.state_hash, world.hash());
    EXPECT_NEAR(summary.reaction_n[1], 10 * 9.81, 1e-6);
    const auto json = nlohmann::json::parse(report.to_json(summary));
    EXPECT_EQ(json["steps"], 3);
    EXPECT_GT(json["energy_j"]["kinetic"].get<double>(), 0);
    EXPECT_EQ(json["flags"], nlohmann::json::array());
}

}  // namespace
}  // namespace supple::io
