#include "supple/world/stages.h"

#include <algorithm>
#include <cmath>

#include "supple/solve/chunked_sum.h"

namespace supple {

namespace {

using solve::kRowChunk;

/// Velocity that a prescribed motion asks of a vertex, so that it arrives on time.
Vec3 prescribed_velocity(const Body& body, const Motion& motion, std::size_t vertex, double time_s, double h) {
    const Vec3& X = body.start.x[vertex];
    const Vec3& x = body.state.x[vertex];
    if (!motion.velocity_m_s.values.empty()) return motion.velocity_m_s.at(time_s);
    if (!motion.affine.values.empty()) {
        const Mat34 A = motion.affine.at(time_s);
        return (A.leftCols<3>() * X + A.col(3) - x) / h;
    }
    return (X + motion.displacement_m.at(time_s) - x) / h;
}

}  // namespace

void stiffness_product(StepContext& ctx, Body& body, const std::vector<Vec3>& field) {
    body.elements->product(ctx.team, body.state.quaternion.data(), field, body.work.corner, body.work.product);
}

void prepare_step(StepContext& ctx, Body& body) {
    const WorldDef& def = ctx.world.def;
    Workspace& w = body.work;
    ctx.team.for_range(body.vertices(), kRowChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            w.f_ext[i] = body.mass[i] * def.gravity_m_s2;
            w.v0[i] = body.state.v[i];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::int32_t owner = body.owner[i * 3 + axis];
                if (owner == kFree) continue;
                const auto c = Eigen::Index(axis);
                w.v0[i][c] = owner == kHeld ? 0.0
                                            : prescribed_velocity(body, body.motions[std::size_t(owner)], i, ctx.time_s, def.time_step_s)[c];
            }
        }
    });
    body.loads.add_dead(ctx.time_s, w.f_ext);
    if (!body.loads.any_follower()) return;
    std::copy(w.f_ext.begin(), w.f_ext.end(), w.f_dead.begin());
    for (std::size_t i = 0; i < body.vertices(); ++i) w.y[i] = body.state.x[i] + def.time_step_s * w.v0[i];
    body.loads.add_followers(ctx.team, ctx.time_s, w.y, w.f_ext);
}

double evaluate_elements(StepContext& ctx, Body& body, bool at_current) {
    const TemplateData& data = body.data();
    const WorldDef& def = ctx.world.def;
    const double h = def.time_step_s, alpha = def.solver.rayleigh_mass_1_s;
    Workspace& w = body.work;
    BodyState& s = body.state;

    ctx.team.for_range(body.vertices(), kRowChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) w.y[i] = at_current ? s.x[i] : Vec3(s.x[i] + h * w.v0[i]);
    });
    if (body.loads.any_follower()) {
        std::copy(w.f_dead.begin(), w.f_dead.end(), w.f_ext.begin());
        body.loads.add_followers(ctx.team, ctx.time_s, w.y, w.f_ext);
    }
    fem::ElementOutputs outputs;
    outputs.corner_force = w.corner.data();
    outputs.tangent = true;
    body.elements->evaluate(ctx.team, w.y.data()->data(), s.quaternion.data(), outputs);
    ctx.team.for_range(body.vertices(), kRowChunk, [&](std::size_t begin, std::size_t end) {
        fem::gather_corners(data.corners, w.corner.data(), begin, end, w.b.data());
        for (std::size_t i = begin; i < end; ++i) {
            w.b[i] = h * (w.b[i] + w.f_ext[i] - alpha * body.mass[i] * w.v0[i]) - body.mass[i] * (w.v0[i] - s.v[i]);
        }
    });
    const double damping = h * def.solver.rayleigh_stiffness_s + (at_current ? h * h : 0.0);
    if (damping > 0) {
        stiffness_product(ctx, body, w.v0);
        ctx.team.for_range(body.vertices(), kRowChunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) w.b[i] -= damping * w.product[i];
        });
    }
    return std::sqrt(solve::sum_over_rows(ctx.team, body.vertices(), w.partial, [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t i = begin; i < end; ++i) sum += free_part(body, i, w.b[i]).squaredNorm();
        return sum;
    }));
}

void assemble(StepContext& ctx, Body& body) {
    const TemplateData& data = body.data();
    const WorldDef& def = ctx.world.def;
    const double mass = mass_scale(def);
    Workspace& w = body.work;
    for (std::size_t i = 0; i < body.vertices(); ++i) w.diagonal[i] = mass * body.mass[i];
    with_system(body, [&](auto& system) {
        using Real = typename std::remove_reference_t<decltype(system)>::Scalar;
        body.elements->assemble(ctx.team, stiffness_scale(def), w.diagonal, system.A.value.data());
        // Held coordinates: zero rows and columns, one on the diagonal.
        ctx.team.for_range(body.held_rows.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                const std::size_t row = std::size_t(body.held_rows[k]);
                for (std::int32_t block = data.pattern.row_start[row]; block < data.pattern.row_start[row + 1]; ++block) {
                    const std::size_t column = std::size_t(data.pattern.column[std::size_t(block)]);
                    Real* value = system.A.value.data() + std::size_t(block) * 12;
                    for (std::size_t c = 0; c < 3; ++c) {
                        for (std::size_t i = 0; i < 3; ++i) {
                            if (body.is_held(row, i) || body.is_held(column, c)) value[4 * c + i] = Real(row == column && i == c ? 1 : 0);
                        }
                    }
                }
            }
        });
    });
}

bool integrate(StepContext& ctx, BodyId id, Body& body) {
    const double h = ctx.world.def.time_step_s;
    Workspace& w = body.work;
    BodyState& s = body.state;
    const double size = solve::sum_over_rows(ctx.team, body.vertices(), w.partial, [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t i = begin; i < end; ++i) sum += (s.x[i] + h * w.v0[i]).squaredNorm() + w.v0[i].squaredNorm();
        return sum;
    });
    if (!std::isfinite(size)) return false;
    s.dv2.swap(s.dv1);
    ctx.team.for_range(body.vertices(), kRowChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            s.dv1[i] = free_part(body, i, w.v0[i] - s.v[i]);
            s.v[i] = w.v0[i];
            s.x_previous[i] = s.x[i];
            s.x[i] += h * s.v[i];
        }
    });
    body.stress.valid = false;
    read_drags(ctx.world, id, body);
    return true;
}

void contain(StepContext& ctx, BodyId id, Body& body) {
    BodyState& s = body.state;
    s.frozen[0] = 1;
    s.x_previous = s.x;
    std::fill(s.v.begin(), s.v.end(), Vec3::Zero());
    std::fill(s.dv1.begin(), s.dv1.end(), Vec3::Zero());
    std::fill(s.dv2.begin(), s.dv2.end(), Vec3::Zero());
    std::fill(s.reaction.begin(), s.reaction.end(), Vec3::Zero());
    fem::seed_rotations(ctx.team, body.data().rest, s.x, s.quaternion);
    body.stress.valid = false;
    drop_drags(ctx.world, id);
    ctx.report.flags |= StepFlag::non_finite;
}

}  // namespace supple
