#pragma once
// The matrix of one implicit step of a body, in Real and in Eigen's form, with held coordinates.
#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <memory>
#include <vector>

#include "supple/fem/elements.h"
#include "supple/fem/rest.h"
#include "supple/solve/lattice_multigrid.h"
#include "supple/solve/linear_solver.h"
#include "supple/world/template_data.h"
#include "bodies.h"

namespace supple::test {

template <class Real>
struct ElasticProblem {
    struct Def {
        double young_pa = 1e5, poisson = 0.4, time_step_s = 0.01;
        double inclusion = 1;           ///< Young's modulus of every seventh element is so many times higher
        Mat3 turn = Mat3::Identity();   ///< the body stands turned by this
    };

    std::shared_ptr<const BodyTemplate> shape;
    const solve::Bsr3Pattern& pattern;
    std::vector<Vec3> points;           ///< [row] at rest
    std::vector<std::uint8_t> held;     ///< [row] bit c: coordinate c
    solve::Bsr3<Real> A;
    Eigen::SparseMatrix<double> matrix;
    std::vector<Vec3> b;
    AlignedVector<double> quaternion;
    Team team;
    double volume = 0;

    template <class Held>
    ElasticProblem(std::shared_ptr<const BodyTemplate> body, const Def& def, Held&& held_bits, int threads = 1)
        : shape(std::move(body)), pattern(shape->data().pattern), points(solve::by_row(pattern, std::span(shape->mesh().vertices))), team(threads) {
        const TemplateData& data = shape->data();
        const fem::ElementLayout& layout = data.layout;
        const std::size_t n = layout.vertices;
        fem::ElementsDef elements_def;
        elements_def.layout = &layout;
        elements_def.pattern = {pattern.row_start, pattern.column, pattern.mirror};
        for (const solve::GatherMap& map : data.gather) elements_def.contributions.push_back({map.start, map.pair});
        elements_def.precision = sizeof(Real) == 4 ? fem::MatrixPrecision::single : fem::MatrixPrecision::double_;
        elements_def.isa = best_isa();
        fem::ElementMaterials materials{{Corotational{.young_pa = def.young_pa, .poisson = def.poisson}}, {}, {}};
        for (std::size_t e = 0; e < layout.elements; ++e) materials.stiffness_factor.push_back(e % 7 == 3 ? def.inclusion : 1);
        auto elements = fem::make_elements(elements_def, materials);
        std::vector<Vec3> x = data.mesh.vertices;
        for (Vec3& p : x) p = def.turn * p;
        const Eigen::Quaterniond q(def.turn);
        quaternion.resize(layout.blocks * 4 * fem::kBlock);
        for (std::size_t i = 0; i < quaternion.size(); ++i) {
            const std::size_t k = i / fem::kBlock % 4;
            quaternion[i] = k == 0 ? q.w() : k == 1 ? q.x() : k == 2 ? q.y() : q.z();
        }
        fem::ElementOutputs outputs;
        outputs.tangent = true;
        elements->evaluate(team, x.data()->data(), quaternion.data(), outputs);
        A = {&pattern, AlignedVector<Real>(pattern.blocks() * 12, Real(0))};
        elements->assemble(team, def.time_step_s * def.time_step_s, by_row(fem::lumped_mass(data.mesh, std::vector<double>{1000})), A.value.data());
        for (const double v : layout.volume) volume += v;
        for (std::size_t i = 0; i < n; ++i) held.push_back(held_bits(points[i]));

        std::vector<Eigen::Triplet<double>> triplets;
        for (std::size_t i = 0; i < n; ++i) {
            for (std::int32_t k = pattern.row_start[i]; k < pattern.row_start[i + 1]; ++k) {
                const auto j = std::size_t(pattern.column[std::size_t(k)]);
                for (std::size_t c = 0; c < 3; ++c) {
                    for (std::size_t r = 0; r < 3; ++r) {
                        Real& value = A.value[std::size_t(k) * 12 + 4 * c + r];
                        if ((held[i] >> r & 1) || (held[j] >> c & 1)) value = Real(i == j && r == c ? 1 : 0);
                        triplets.emplace_back(int(3 * i + r), int(3 * j + c), double(value));
                    }
                }
            }
        }
        matrix.resize(Eigen::Index(3 * n), Eigen::Index(3 * n));
        matrix.setFromTriplets(triplets.begin(), triplets.end());
        Random random(5);
        b.resize(n);
        for (std::size_t i = 0; i < n; ++i) {
            b[i] = 1e-4 * (random.vector(1) + Vec3(0, -3, 0));
            for (std::size_t c = 0; c < 3; ++c) {
                if (held[i] >> c & 1) b[i][Eigen::Index(c)] = 0;
            }
        }
    }

    std::vector<double> by_row(const std::vector<double>& of_vertex) const { return solve::by_row(pattern, std::span(of_vertex)); }
    std::size_t rows() const { return pattern.rows; }
    auto rotation() const {
        return [this](std::int32_t id, double* q) {
            const std::size_t slot = shape->data().layout.slot[std::size_t(id)];
            const double* from = quaternion.data() + slot / fem::kBlock * 4 * fem::kBlock + slot % fem::kBlock;
            for (std::size_t k = 0; k < 4; ++k) q[k] = from[k * fem::kBlock];
        };
    }
    std::vector<std::array<std::int32_t, 3>> rotation_of_row() const {
        std::vector<std::array<std::int32_t, 3>> near(rows(), {-1, -1, -1});
        const auto& tets = shape->mesh().tets;
        for (std::size_t e = 0; e < tets.size(); ++e) {
            for (const std::int32_t v : tets[e]) {
                auto& ids = near[std::size_t(pattern.row[std::size_t(v)])];
                for (std::int32_t& id : ids) {
                    if (id < 0) {
                        id = std::int32_t(e);
                        break;
                    }
                }
            }
        }
        return near;
    }
    std::unique_ptr<solve::LatticeMultigrid<Real>> multigrid(Isa isa = best_isa()) {
        auto made = std::make_unique<solve::LatticeMultigrid<Real>>(pattern, isa);
        const auto near = rotation_of_row();
        solve::LatticeDef def;
        def.points = points;
        def.held = held;
        def.rotation_of_row = near;
        def.volume = volume;
        made->build(team, def, A, rotation());
        return made;
    }

    Eigen::Map<const Eigen::VectorXd> flat(const std::vector<Vec3>& v) const { return {v.data()->data(), Eigen::Index(3 * v.size())}; }

    /// A plus the appended rows, solved by Cholesky.
    std::vector<Vec3> direct(std::span<const solve::AppendedRow> appended = {}) const {
        const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(full(appended));
        const Eigen::VectorXd x = solver.solve(flat(b));
        std::vector<Vec3> out(b.size());
        for (std::size_t i = 0; i < out.size(); ++i) out[i] = x.segment<3>(Eigen::Index(3 * i));
        return out;
    }
    Eigen::SparseMatrix<double> full(std::span<const solve::AppendedRow> appended) const {
        Eigen::SparseMatrix<double> sum = matrix;
        for (const solve::AppendedRow& row : appended) {
            std::vector<Eigen::Triplet<double>> extra;
            for (std::size_t i = 0; i < row.row.size(); ++i) {
                for (std::size_t j = 0; j < row.row.size(); ++j) {
                    const Mat3 block = row.weight[i].asDiagonal() * row.stiffness * row.weight[j].asDiagonal();
                    for (int r = 0; r < 3; ++r)
                        for (int c = 0; c < 3; ++c) extra.emplace_back(3 * row.row[i] + r, 3 * row.row[j] + c, block(r, c));
                }
            }
            Eigen::SparseMatrix<double> part(sum.rows(), sum.cols());
            part.setFromTriplets(extra.begin(), extra.end());
            sum += part;
        }
        return sum;
    }

    solve::LinearSolveResult solve(solve::Preconditioner<Real>& preconditioner, double tolerance, std::vector<Vec3>& x,
                                   std::span<const solve::AppendedRow> appended = {}) {
        preconditioner.update(team, A, appended);
        solve::LinearSolver<Real> solver(rows(), best_isa());
        const Eigen::SparseMatrix<double> all = full(appended);
        x.assign(b.size(), Vec3::Zero());
        std::vector<Vec3> r(b.size());
        const solve::SystemPart<Real> part{&A, &preconditioner};
        return solver.solve(
            team, {&part, 1}, appended, b, {}, {.target = tolerance * flat(b).norm()},
            [&](const Vec3* at, Vec3* out) {
                const Eigen::Map<const Eigen::VectorXd> v(at->data(), all.rows());
                Eigen::Map<Eigen::VectorXd>(out->data(), all.rows()) = flat(b) - all * v;
            },
            x, r);
    }
};

}  // namespace supple::test
