#include "supple/world/stress.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "supple/fem/element_geometry.h"
#include "supple/fem/stress.h"
#include "supple/world/evaluate.h"
#include "supple/world/impl.h"
#include "supple/world/stress_field.h"

namespace supple {

namespace {

constexpr std::size_t kChunk = 512;

Mat3 matrix_of(const Voigt& s) {
    Mat3 S;
    S << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
    return S;
}

/// F S F^T / J of S = 2 mu E + lambda tr(E) I. A flat element keeps its sign and stays finite, as in the kernels of hyperelastic laws.
Voigt green_stress(const Mat3& F, const Lame& lame) {
    const Mat3 E = 0.5 * (F.transpose() * F - Mat3::Identity());
    const Mat3 S = 2 * lame.mu_pa * E + lame.lambda_pa * E.trace() * Mat3::Identity();
    double J = F.determinant();
    if (std::abs(J) < 1e-12) J = J < 0 ? -1e-12 : 1e-12;
    const Mat3 sigma = F * S * F.transpose() / J;
    return {sigma(0, 0), sigma(1, 1), sigma(2, 2), sigma(0, 1), sigma(1, 2), sigma(2, 0)};
}

}  // namespace

void fill_stress(const TemplateData& data, const fem::Elements& elements, std::span<const Vec3> positions, std::span<const Voigt> own_stress,
                 const StressDef& def, Team& team, std::vector<Voigt>& scratch, StressField& out) {
    std::vector<Voigt>& green = scratch;
    std::span<const Voigt> element = own_stress;
    if (def.strain == StrainMeasure::green) {
        green.assign(own_stress.begin(), own_stress.end());
        team.for_range(green.size(), kChunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t e = begin; e < end; ++e) {
                if (const auto lame = elements.lame(e)) green[e] = green_stress(fem::element_geometry(data.mesh, e).deformation_gradient(positions), *lame);
            }
        });
        element = green;
    }
    const bool at_elements = def.at == StressAt::element;
    const fem::RecoveryWeights* weights = at_elements ? nullptr : &data.recovery(def.recovery);
    const std::size_t count = at_elements ? element.size() : data.mesh.vertices.size();
    out.cauchy_pa.resize(count);
    out.von_mises_pa.resize(count);
    out.principal_pa.resize(count);
    out.directions.resize(def.directions ? count : 0);
    team.for_range(count, kChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            out.cauchy_pa[i] = at_elements ? element[i] : weights->at(element, i);
            out.von_mises_pa[i] = fem::von_mises(out.cauchy_pa[i]);
            out.principal_pa[i] = principal_stresses(out.cauchy_pa[i], def.directions ? &out.directions[i] : nullptr);
        }
    });
}

std::array<double, 3> principal_stresses(const Voigt& cauchy, Mat3* directions) {
    const Mat3 S = matrix_of(cauchy);
    if (!S.allFinite()) {
        constexpr double nan = std::numeric_limits<double>::quiet_NaN();
        if (directions != nullptr) directions->setConstant(nan);
        return {nan, nan, nan};
    }
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(S, directions != nullptr ? Eigen::ComputeEigenvectors : Eigen::EigenvaluesOnly);
    if (directions != nullptr) {
        for (int k = 0; k < 2; ++k) directions->col(k) = eigen.eigenvectors().col(2 - k);
        directions->col(2) = directions->col(0).cross(directions->col(1));
    }
    return {eigen.eigenvalues()[2], eigen.eigenvalues()[1], eigen.eigenvalues()[0]};
}

double von_mises(const Voigt& cauchy) { return fem::von_mises(cauchy); }

StressField World::stress(BodyId id, const StressDef& def) const {
    StressField field;
    stress(id, def, field);
    return field;
}

void World::stress(BodyId id, const StressDef& def, StressField& out) const {
    const Body& body = impl_->body(id);
    Team& team = impl_->team_for(body.element_count());
    update_stress(body, team);
    fill_stress(body.data(), *body.elements, body.state.x, body.stress.element, def, team, body.stress.scratch, out);
}

}  // namespace supple
