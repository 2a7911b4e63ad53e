#include <gtest/gtest.h>

#include <fstream>

#include "supple/io/matrix_market.h"
#include "supple/io/probe_table.h"
#include "test_io_helpers.h"

namespace supple::io {
namespace {

using test::expect_error;

TEST(IoMatrixMarket, ReadsWhatItWritesBitForBit) {
    Eigen::SparseMatrix<double> general(3, 4);
    general.insert(0, 0) = 1.0 / 3;
    general.insert(2, 3) = -1e-300;
    general.insert(1, 3) = 6.02e23;
    const std::string text = matrix_market_text(general);
    EXPECT_EQ(text.substr(0, text.find('\n')), "%%MatrixMarket matrix coordinate real general");
    EXPECT_NE(text.find("\n3 4 3\n"), std::string::npos);
    EXPECT_EQ(Eigen::MatrixXd(parse_matrix_market(text, "t")), Eigen::MatrixXd(general));

    Eigen::SparseMatrix<double> symmetric(3, 3);
    symmetric.insert(0, 0) = 2;
    symmetric.insert(1, 0) = symmetric.insert(0, 1) = 0.1;
    symmetric.insert(2, 2) = -1;
    const std::string half = matrix_market_text(symmetric);
    EXPECT_NE(half.find("real symmetric\n3 3 3\n"), std::string::npos) << half;
    EXPECT_EQ(Eigen::MatrixXd(parse_matrix_market(half, "t")), Eigen::MatrixXd(symmetric));
    symmetric.coeffRef(0, 1) += 1e-16;
    EXPECT_NE(matrix_market_text(symmetric).find("general"), std::string::npos);
}

TEST(IoMatrixMarket, RefusesWhatItCannotRead) {
    const auto refuse = [](const std::string& text, const std::string& where, const std::vector<std::string>& words) {
        expect_error(ErrorCode::parse, where, words, [&] { parse_matrix_market(text, "m.mtx"); });
    };
    refuse("3 3 1\n", "m.mtx:1", {"%%MatrixMarket"});
    refuse("%%MatrixMarket matrix array real general\n", "m.mtx:1", {"coordinate"});
    refuse("%%MatrixMarket matrix coordinate real hermitian\n", "m.mtx:1", {"hermitian"});
    refuse("%%MatrixMarket matrix coordinate real general\n% c\n2 2 1\n3 1 5\n", "m.mtx:4", {"3"});
    refuse("%%MatrixMarket matrix coordinate real general\n2 2 1\n1 1 5\n2 2 5\n", "m.mtx:4", {"more"});
    refuse("%%MatrixMarket matrix coordinate real general\n2 2 2\n1 1 5\n", "m.mtx:4", {});
}

TEST(IoProbes, OfASceneBecomeRowsOfATable) {
    const Scene scene = parse_scene(R"({"supple_scene": 1, "threads": 1, "time_step_s": 0.01, "bodies": [{"name": "a, b", "box": {"min_m": [0, 0, 0], "max_m": [2, 1, 1], "cells": [2, 1, 1]},
        "fixed": [{"box": {"min_m": [0, 0, 0], "max_m": [0, 1, 1]}}],
        "probes": [{"all": true, "threshold_pa": 1}, {"vertices": [0, 1], "name": "two", "threshold_m": 3, "strain": "green"}]}]})", ".", "s.json");
    ASSERT_EQ(scene.bodies[0].probes.size(), 2u);
    EXPECT_EQ(scene.bodies[0].probes[1].threshold_m, 3);
    EXPECT_EQ(scene.bodies[0].probes[1].strain, StrainMeasure::green);
    World world = build_world(scene);
    std::vector<Probe> probes = make_probes(scene, world);
    ASSERT_EQ(probes.size(), 2u);
    ProbeTable table;
    for (int n = 0; n < 3; ++n) {
        world.step();
        for (Probe& p : probes) {
            p.read(world);
            table.add(world, p);
        }
    }
    const std::string& text = table.text();
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 7);
    EXPECT_EQ(text.substr(0, 5), "step,");
    EXPECT_NE(text.find("\n3,0.02999999999999999"), std::string::npos) << text;
    EXPECT_NE(text.find(",\"a, b\",probe 0,"), std::string::npos);
    EXPECT_NE(text.find(",\"a, b\",two,"), std::string::npos);
    EXPECT_GT(probes[0].sample().over_threshold_s, 0.029);
    expect_error(ErrorCode::parse, "s.json:/bodies/0/probes/0/threshold_pa", {}, [&] {
        parse_scene(R"({"supple_scene": 1, "bodies": [{"box": {"min_m": [0, 0, 0], "max_m": [2, 1, 1], "cells": [2, 1, 1]}, "probes": [{"all": true, "threshold_pa": 0}]}]})", ".", "s.json");
    });
}

}  // namespace
}  // namespace supple::io
