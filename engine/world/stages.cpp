#include "supple/world/stages.h"

#include <algorithm>
#include <cmath>

#include "supple/solve/chunked_sum.h"
#include "supple/world/contact_stages.h"

namespace supple {

using solve::kRowChunk;

/// A body so many times larger than at rest has blown up, though its numbers are finite still: a step diverged.
constexpr double kBlownUp = 1e6;

void stiffness_product(StepContext& ctx, Body& body, const std::vector<Vec3>& field) {
    fem::stiffness_product(ctx.team, *body.elements, body.layout(), body.state.quaternion.data(), field, body.work.force_parts, body.work.product);
}

void tangent_product(StepContext& ctx, Body& body, const std::vector<Vec3>& field) {
    stiffness_product(ctx, body, field);
    if (!body.work.project) body.loads.add_stiffness_product(ctx.time_s, body.work.y, field, body.work.product);
}

void gather_loads(StepContext& ctx, Body& body, double time_s) {
    Workspace& w = body.work;
    ctx.team.for_range(body.vertices(), kRowChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) w.f_ext[i] = body.mass[i] * ctx.world.def.gravity_m_s2;
    });
    body.loads.add_dead(time_s, w.f_ext);
    if (!body.loads.any_follower()) return;
    std::copy(w.f_ext.begin(), w.f_ext.end(), w.f_dead.begin());
    body.loads.add_followers(ctx.team, time_s, body.state.x, w.f_ext);
}

double evaluate_elements(StepContext& ctx, Body& body, bool at_current) {
    const SolverDef& def = ctx.world.def.solver;
    Workspace& w = body.work;
    BodyState& s = body.state;
    const double h = w.h, alpha = def.rayleigh_mass_1_s, beta = def.rayleigh_stiffness_s;
    const bool inertia = !is_static(ctx);

    ctx.team.for_range(body.vertices(), kRowChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) w.y[i] = at_current ? s.x[i] : Vec3(w.base_x[i] + h * w.v0[i]);
    });
    if (body.loads.any_follower()) {
        std::copy(w.f_dead.begin(), w.f_dead.end(), w.f_ext.begin());
        body.loads.add_followers(ctx.team, ctx.time_s, w.y, w.f_ext);
    }
    fem::ElementOutputs outputs;
    outputs.force = w.force_parts.data();
    outputs.plastic = plastic_strain(body);
    outputs.tangent = true;
    outputs.project = w.project;
    body.elements->evaluate(ctx.team, w.y.data()->data(), s.quaternion.data(), outputs);
    ctx.team.for_range(body.vertices(), kRowChunk, [&](std::size_t begin, std::size_t end) {
        fem::gather_places(body.layout().forces, w.force_parts.data(), begin, end, w.b.data());
        for (std::size_t i = begin; i < end; ++i) {
            if (inertia) {
                w.b[i] = h * (w.b[i] + w.f_ext[i] - alpha * body.mass[i] * w.v0[i]) - body.mass[i] * (w.v0[i] - w.base_v[i]);
            } else {
                w.b[i] = h * (w.b[i] + w.f_ext[i]);
                if (w.withheld > 0) w.b[i] -= w.withheld * w.unbalance[i];
            }
        }
    });
    if (inertia && (beta > 0 || at_current)) {
        ctx.team.for_range(body.vertices(), kRowChunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                w.dv[i] = beta * w.v0[i];
                if (at_current) w.dv[i] += w.base_x[i] + h * w.v0[i] - s.x[i];
            }
        });
        stiffness_product(ctx, body, w.dv);
        ctx.team.for_range(body.vertices(), kRowChunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) w.b[i] -= h * w.product[i];
        });
    }
    return std::sqrt(solve::sum_over_rows(ctx.team, body.vertices(), w.partial, [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t i = begin; i < end; ++i) sum += free_part(body, i, w.b[i]).squaredNorm();
        return sum;
    }));
}

void assemble_matrix(Team& team, Body& body, double time_s) {
    const TemplateData& data = body.data();
    Workspace& w = body.work;
    for (std::size_t row = 0; row < body.vertices(); ++row) w.diagonal[row] = w.mass_scale * body.mass[std::size_t(data.pattern.vertex[row])];
    with_system(body, [&](auto& system) {
        using Real = typename std::remove_reference_t<decltype(system)>::Scalar;
        system.by_elements = false;
        body.elements->assemble(team, w.stiffness_scale, w.diagonal, system.A.value.data());
        if (!w.project) body.loads.add_stiffness(time_s, w.y, w.stiffness_scale, system.A.value.data());
        // Held coordinates: zero rows and columns, one on the diagonal.
        team.for_range(body.held_rows.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                const std::size_t row = std::size_t(body.held_rows[k]), vertex = std::size_t(data.pattern.vertex[row]);
                for (std::int32_t block = data.pattern.row_start[row]; block < data.pattern.row_start[row + 1]; ++block) {
                    const std::size_t column = std::size_t(data.pattern.column[std::size_t(block)]), other = std::size_t(data.pattern.vertex[column]);
                    Real* value = system.A.value.data() + std::size_t(block) * 12;
                    for (std::size_t c = 0; c < 3; ++c) {
                        for (std::size_t i = 0; i < 3; ++i) {
                            if (body.is_held(vertex, i) || body.is_held(other, c)) value[4 * c + i] = Real(row == column && i == c ? 1 : 0);
                        }
                    }
                }
            }
        });
    });
}

void assemble(StepContext& ctx, Body& body, const Island& island) {
    Workspace& w = body.work;
    w.mass_scale = mass_scale(ctx, body);
    w.stiffness_scale = stiffness_scale(ctx, body);
    const bool by_elements = solves_by_elements(ctx, body, island);
    if (!by_elements) assemble_matrix(ctx.team, body, ctx.time_s);
    with_system(body, [&](auto& system) {
        system.by_elements = by_elements;
        if (by_elements) system.element_operator.update(ctx, body);
        if (system.coupling) system.preconditioner->coupling_diagonal = system.coupling->update_diagonal(ctx.team, w.stiffness_scale);
    });
}

namespace {

bool is_finite(StepContext& ctx, Body& body) {
    const Workspace& w = body.work;
    const auto end = [&](std::size_t i) -> Vec3 { return w.base_x[i] + w.h * w.v0[i]; };
    const Vec3 first = end(0);
    const double spread = solve::sum_over_rows(ctx.team, body.vertices(), body.work.partial, [&](std::size_t begin, std::size_t last) {
        double sum = 0;
        // The second term only makes a velocity that float64 cannot square count as blown up, wherever the body is.
        for (std::size_t i = begin; i < last; ++i) sum += (end(i) - first).squaredNorm() + 1e-300 * w.v0[i].squaredNorm();
        return sum;
    });
    const TemplateData& rest = body.data();
    const double limit = kBlownUp * (rest.max_m - rest.min_m).norm();
    return first.allFinite() && spread <= limit * limit * double(body.vertices());
}

}  // namespace

bool integrate(StepContext& ctx, Island& island) {
    for (const Member& member : island.members) {
        if (!is_finite(ctx, *member.body)) return false;
    }
    for (const Member& member : island.members) {
        end_scheme(ctx, *member.body);
        member.body->stress.valid = false;
        read_drags(ctx.world, member.id, *member.body);
    }
    return true;
}

void contain(StepContext& ctx, BodyId id, Body& body) {
    BodyState& s = body.state;
    s.frozen[0] = 1;
    s.x_previous = s.x;
    std::fill(s.v.begin(), s.v.end(), Vec3::Zero());
    std::fill(s.dv1.begin(), s.dv1.end(), Vec3::Zero());
    std::fill(s.dv2.begin(), s.dv2.end(), Vec3::Zero());
    s.moving[0] = 0;
    std::fill(s.reaction.begin(), s.reaction.end(), Vec3::Zero());
    fem::seed_rotations(ctx.team, body.layout(), s.x, s.quaternion);
    body.stress.valid = false;
    drop_drags(ctx.world, id);
    undo_contacts(ctx, body);
    ctx.report.flags |= StepFlag::non_finite;
}

}  // namespace supple
