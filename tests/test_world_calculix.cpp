// Static equilibria against CalculiX (Debian package calculix-ccx), an independent finite-element program: linear elasticity on C3D4, and its geometrically
// nonlinear elasticity, which is a St. Venant-Kirchhoff law (second Piola-Kirchhoff stress linear in Green's strain). Its hyperelastic laws have other
// volumetric terms than ours and are not compared.
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "supple/world/evaluate.h"
#include "supple/world/inspect.h"
#include "support/bodies.h"

namespace supple {
namespace {

namespace fs = std::filesystem;

constexpr double kYoung = 2e5, kPoisson = 0.3;

/// A number as it stands in an input file, read back: both programs see the same bits.
std::string field(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.11e", value);
    return text;
}
double rounded(double value) { return std::strtod(field(value).c_str(), nullptr); }

struct Problem {
    VolumeMesh mesh;
    std::vector<Vec3> force;     ///< [vertex]
    std::vector<bool> held;
};

/// A shaken block, clamped at x = 0, forces on its other end.
Problem make_problem(double size_n) {
    Problem p;
    p.mesh = make_tet_box({.min_m = Vec3::Zero(), .max_m = {0.3, 0.1, 0.1}, .cells = {6, 2, 2}});
    test::Random random(12);
    p.force.assign(p.mesh.vertices.size(), Vec3::Zero());
    for (std::size_t v = 0; v < p.mesh.vertices.size(); ++v) {
        Vec3& x = p.mesh.vertices[v];
        p.held.push_back(x.x() < 1e-9);
        if (x.x() > 0.3 - 1e-9) p.force[v] = size_n * Vec3(0.2, -1, 0.4) / 9;
        x += random.vector(0.008);
        for (int c = 0; c < 3; ++c) x[c] = rounded(x[c]), p.force[v][c] = rounded(p.force[v][c]);
    }
    return p;
}

struct Answer {
    std::vector<Vec3> displacement;
    std::vector<Voigt> stress;  ///< [element]
};

void write_input(const fs::path& file, const Problem& p, bool nonlinear) {
    std::ofstream out(file);
    out << "*NODE, NSET=NALL\n";
    for (std::size_t v = 0; v < p.mesh.vertices.size(); ++v) {
        out << v + 1;
        for (int c = 0; c < 3; ++c) out << ", " << field(p.mesh.vertices[v][c]);
        out << '\n';
    }
    out << "*ELEMENT, TYPE=C3D4, ELSET=EALL\n";
    for (std::size_t e = 0; e < p.mesh.tets.size(); ++e) {
        out << e + 1;
        for (const std::int32_t v : p.mesh.tets[e]) out << ", " << v + 1;
        out << '\n';
    }
    out << "*MATERIAL, NAME=M\n*ELASTIC\n" << field(kYoung) << ", " << field(kPoisson) << "\n*SOLID SECTION, ELSET=EALL, MATERIAL=M\n*BOUNDARY\n";
    for (std::size_t v = 0; v < p.held.size(); ++v)
        if (p.held[v]) out << v + 1 << ", 1, 3\n";
    out << (nonlinear ? "*STEP, NLGEOM\n*CONTROLS, PARAMETERS=FIELD\n1e-9, 1e-9\n" : "*STEP\n") << "*STATIC\n" << (nonlinear ? "0.25, 1.\n" : "") << "*CLOAD\n";
    for (std::size_t v = 0; v < p.force.size(); ++v)
        for (int c = 0; c < 3; ++c)
            if (p.force[v][c] != 0) out << v + 1 << ", " << c + 1 << ", " << field(p.force[v][c]) << '\n';
    out << "*NODE PRINT, NSET=NALL, FREQUENCY=1000\nU\n*EL PRINT, ELSET=EALL, FREQUENCY=1000\nS\n*END STEP\n";
}

/// The last displacements and stresses of a .dat file.
Answer read_answer(const fs::path& file, const Problem& p) {
    Answer answer{std::vector<Vec3>(p.mesh.vertices.size(), Vec3::Constant(NAN)), std::vector<Voigt>(p.mesh.tets.size())};
    std::ifstream in(file);
    std::string line;
    bool stresses = false;
    while (std::getline(in, line)) {
        if (line.find("displacements") != std::string::npos) stresses = false;
        if (line.find("stresses") != std::string::npos) stresses = true;
        std::istringstream words(line);
        std::size_t id = 0, point = 0;
        if (!(words >> id)) continue;
        if (stresses) {
            Voigt s{};
            words >> point >> s[0] >> s[1] >> s[2] >> s[3] >> s[5] >> s[4];  // theirs: xx yy zz xy xz yz
            answer.stress.at(id - 1) = s;
        } else {
            Vec3& u = answer.displacement.at(id - 1);
            words >> u[0] >> u[1] >> u[2];
        }
        EXPECT_FALSE(words.fail()) << line;
    }
    return answer;
}

/// Newton's method with our matrices, held coordinates struck out.
Answer solve(const Problem& p, const Material& material, int iterations) {
    World world({.gravity_m_s2 = Vec3::Zero(), .threads = 1});
    const BodyId body = world.add_body({.shape = BodyTemplate::build(p.mesh), .material = material});
    const Inspector inspector(world, body);
    const std::size_t n = p.mesh.vertices.size();
    std::vector<Vec3> x = p.mesh.vertices;
    for (int k = 0; k < iterations; ++k) {
        world.set_state(body, x, std::vector<Vec3>(n, Vec3::Zero()));
        const std::vector<Vec3> internal = evaluate(world.shape(body), material, x).forces_n;
        Eigen::VectorXd b(Eigen::Index(3 * n));
        for (std::size_t v = 0; v < n; ++v) b.segment<3>(Eigen::Index(3 * v)) = p.held[v] ? Vec3(Vec3::Zero()) : Vec3(p.force[v] + internal[v]);
        std::vector<Eigen::Triplet<double>> triplets;
        inspector.add(SystemMatrix::stiffness, 1, 0, 0, [&](Eigen::Index r, Eigen::Index c, double value) {
            if (p.held[std::size_t(r / 3)] || p.held[std::size_t(c / 3)]) value = r == c ? 1 : 0;
            triplets.emplace_back(int(r), int(c), value);
        });
        Eigen::SparseMatrix<double> K(b.size(), b.size());
        K.setFromTriplets(triplets.begin(), triplets.end());
        const Eigen::SparseLU<Eigen::SparseMatrix<double>> lu(K);
        const Eigen::VectorXd du = lu.solve(b);
        for (std::size_t v = 0; v < n; ++v) x[v] += du.segment<3>(Eigen::Index(3 * v));
        if (k + 1 == iterations) {
            EXPECT_LT(du.norm(), iterations > 1 ? 1e-10 : HUGE_VAL) << "Newton has converged";
        }
    }
    Answer answer;
    for (std::size_t v = 0; v < n; ++v) answer.displacement.push_back(x[v] - p.mesh.vertices[v]);
    answer.stress = evaluate_stress(world.shape(body), material, x, {.at = StressAt::element}).cauchy_pa;
    return answer;
}

/// One step of the static integrator.
Answer step(const Problem& p, const Material& material) {
    WorldDef def;
    def.gravity_m_s2 = Vec3::Zero();
    def.threads = 1;
    def.solver.integrator = Integrator::quasi_static;
    def.solver.newton_tolerance = 1e-10;
    def.solver.cg_relative_tolerance = 1e-12;
    def.solver.precision = Precision::double_;
    World world(def);
    const BodyId body = world.add_body({.shape = BodyTemplate::build(p.mesh), .material = material});
    VertexList held;
    for (std::size_t v = 0; v < p.held.size(); ++v) {
        if (p.held[v]) held.vertices.push_back(std::int32_t(v));
        if (p.force[v].norm() > 0) world.add_load(body, {VertexList{{std::int32_t(v)}}, LoadKind::force_per_vertex, {{}, {p.force[v]}}});
    }
    world.fix(body, held);
    EXPECT_EQ(world.step().flags, StepFlag::none);
    Answer answer;
    for (std::size_t v = 0; v < p.held.size(); ++v) answer.displacement.push_back(world.positions(body)[v] - p.mesh.vertices[v]);
    answer.stress = world.stress(body, {.at = StressAt::element}).cauchy_pa;
    return answer;
}

void expect_same(const Answer& ours, const Answer& theirs, const char* who) {
    double largest = 0, difference = 0, stress = 0, stress_difference = 0;
    for (std::size_t v = 0; v < ours.displacement.size(); ++v) {
        largest = std::max(largest, ours.displacement[v].norm());
        ASSERT_TRUE(theirs.displacement[v].allFinite()) << "vertex " << v;
        difference = std::max(difference, (ours.displacement[v] - theirs.displacement[v]).norm());
    }
    for (std::size_t e = 0; e < ours.stress.size(); ++e) {
        for (std::size_t c = 0; c < 6; ++c) {
            stress = std::max(stress, std::abs(ours.stress[e][c]));
            stress_difference = std::max(stress_difference, std::abs(ours.stress[e][c] - theirs.stress[e][c]));
        }
    }
    std::printf("CalculiX against %s: largest displacement %.4g m, differing by %.2g of it; stresses by %.2g of the largest\n", who, largest, difference / largest,
                stress_difference / stress);
    EXPECT_GT(largest, 1e-4);
    EXPECT_LT(difference, 1e-5 * largest);
    EXPECT_LT(stress_difference, 1e-5 * stress);
}

void compare(const Problem& p, const Material& material, bool nonlinear, int iterations) {
    if (std::system("command -v ccx > /dev/null 2>&1") != 0) {
        std::printf("skipped: no ccx on the PATH (apt-get install calculix-ccx); nothing was compared with CalculiX\n");
        GTEST_SKIP() << "no ccx on the PATH (apt-get install calculix-ccx)";
    }
    const fs::path folder = fs::temp_directory_path() / ("supple_ccx_" + std::to_string(getpid()) + (nonlinear ? "_n" : "_l"));
    fs::create_directories(folder);
    write_input(folder / "block.inp", p, nonlinear);
    ASSERT_EQ(std::system(("cd '" + folder.string() + "' && OMP_NUM_THREADS=1 ccx block > log.txt 2>&1").c_str()), 0);
    const Answer theirs = read_answer(folder / "block.dat", p);
    fs::remove_all(folder);
    expect_same(solve(p, material, iterations), theirs, "the exported matrices");
    expect_same(step(p, material), theirs, "the static integrator");
}

TEST(SlowCalculix, LinearElasticityOfAShakenBlock) { compare(make_problem(2), Linear{kYoung, kPoisson}, false, 1); }

TEST(SlowCalculix, StVenantKirchhoffAtLargeDisplacements) {
    const Lame l = lame_parameters(kYoung, kPoisson, "");
    compare(make_problem(10), StVenantKirchhoff{l.mu_pa, l.lambda_pa}, true, 12);
}

}  // namespace
}  // namespace supple
