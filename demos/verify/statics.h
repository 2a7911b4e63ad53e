#pragma once
// One body in equilibrium: what most cases are made of.
#include <functional>
#include <span>
#include <vector>

#include "meshes.h"
#include "supple/world/world.h"

namespace supple::verify {

using Where = std::function<bool(const Vec3& X)>;

/// |X[axis] - value| < 1e-9 of the coordinate's size.
Where on_plane(int axis, double value);
inline Where everywhere() {
    return [](const Vec3&) { return true; };
}

struct StaticDef {
    double tolerance = 1e-9;  ///< of Newton, relative to loads and reactions
    int threads = 0;
    Vec3 gravity_m_s2 = Vec3::Zero();
    double density_kg_m3 = 1000;
    PreconditionerKind preconditioner = PreconditionerKind::direct;
};

class Statics {
public:
    Statics(VolumeMesh mesh, const Material& material, const StaticDef& def = {});

    /// Rest positions are X of the caller's functions.
    std::vector<std::int32_t> select(const Where& where) const;
    void hold(const Where& where, Axes axes = {});
    /// The affine map x = A X + t at the end of each step; several maps, one per step.
    void move(const Where& where, const std::vector<Mat34>& maps);
    /// Forces per vertex [N] (quadrature.h). `factors`: multiplies them in step 1, 2, ..
    void load(std::span<const Vec3> forces, const std::vector<double>& factors = {1});

    /// Follower pressure [Pa] on the boundary faces whose corners are all selected, one value per step.
    void press(const Where& where, const std::vector<double>& pressures_pa);

    /// Equilibrium of the next step. @error std::runtime_error when there is none
    void solve();

    World& world() { return world_; }
    int newton_iterations() const { return newton_iterations_; }  ///< of all solves so far
    const VolumeMesh& mesh() const { return world_.shape(body_).mesh(); }
    BodyId body() const { return body_; }
    std::span<const Vec3> x() const { return world_.positions(body_); }
    Vec3 displacement(std::size_t vertex) const { return x()[vertex] - mesh().vertices[vertex]; }
    /// Mean displacement of the selected vertices.
    Vec3 displacement(const Where& where) const;
    /// Cauchy stress per vertex by superconvergent patch recovery, after solve().
    std::span<const Voigt> nodal_stress() const;
    /// Recovered Cauchy stress at the vertex nearest to a place.
    Voigt stress_at(const Vec3& X) const;
    std::size_t nearest(const Vec3& X) const;

private:
    World world_;
    BodyId body_;
    int newton_iterations_ = 0;
    mutable std::vector<Voigt> nodal_stress_;
};

/// Stiffness-free text of step flags, for messages.
std::string flags_text(StepFlag flags);

}  // namespace supple::verify
