/// The integrators. Each is one and the same equation in the velocity v at the end of the step,
///
///     x = base_x + h' v,        M (v - base_v)/h' = f(x) + f_ext - C v,
///
/// with its own h' and bases (x, v, a: at the start of the step; older: at the start of the one before):
///
///     implicit Euler      h' = h          base_x = x                    base_v = v
///     bdf2                h' = 2h/3       base_x = (4 x - older x)/3    base_v = (4 v - older v)/3
///     trapezoidal rule    h' = h/2        base_x = x + h v/2            base_v = v + h a/2
///     static              h' = h          base_x = x                    no mass: f(x) + f_ext = 0
///
/// A held coordinate moves to its target with the mean velocity of the step, whatever the scheme: its base follows from that.
#include "supple/solve/chunked_sum.h"
#include "supple/world/stages.h"

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

/// The accelerations that a trapezoidal rule starts from: those of the free vertices under the forces of this moment.
void start_accelerations(StepContext& ctx, Body& body) {
    const WorldDef& def = ctx.world.def;
    Workspace& w = body.work;
    BodyState& s = body.state;
    gather_loads(ctx, body, ctx.time_s - def.time_step_s);
    fem::ElementOutputs outputs;
    outputs.force = w.force_parts.data();
    outputs.plastic = plastic_strain(body);
    outputs.tangent = true;
    body.elements->evaluate(ctx.team, s.x.data()->data(), s.quaternion.data(), outputs);
    stiffness_product(ctx, body, s.v);
    const double alpha = def.solver.rayleigh_mass_1_s, beta = def.solver.rayleigh_stiffness_s;
    ctx.team.for_range(body.vertices(), kRowChunk, [&](std::size_t begin, std::size_t end) {
        fem::gather_places(body.layout().forces, w.force_parts.data(), begin, end, w.b.data());
        for (std::size_t i = begin; i < end; ++i) {
            s.a[i] = Vec3::Zero();
            if (body.mass[i] > 0) s.a[i] = free_part(body, i, (w.b[i] + w.f_ext[i] - beta * w.product[i]) / body.mass[i] - alpha * s.v[i]);
        }
    });
}

}  // namespace

void begin_scheme(StepContext& ctx, Body& body) {
    const WorldDef& def = ctx.world.def;
    const Integrator integrator = def.solver.integrator;
    const double h = def.time_step_s;
    Workspace& w = body.work;
    BodyState& s = body.state;
    const bool history = s.moving[0] != 0;
    if (integrator == Integrator::newmark && !history) start_accelerations(ctx, body);
    const bool second_order = integrator == Integrator::newmark || (integrator == Integrator::bdf2 && history);
    w.h = integrator == Integrator::bdf2 && !history ? h : scheme_step(def);
    ctx.team.for_range(body.vertices(), kRowChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            w.v0[i] = s.v[i];
            w.base_x[i] = s.x[i];
            w.base_v[i] = s.v[i];
            if (integrator == Integrator::newmark) {
                w.base_x[i] += h / 2 * s.v[i];
                w.base_v[i] += h / 2 * s.a[i];
            } else if (second_order) {
                w.base_x[i] = (4 * s.x[i] - s.x_previous[i]) / 3;
                w.base_v[i] = (4 * s.v[i] - s.v_previous[i]) / 3;
            } else if (integrator == Integrator::quasi_static) {
                w.v0[i] = Vec3::Zero();
            }
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::int32_t owner = body.owner[i * 3 + axis];
                if (owner == kFree) continue;
                const auto c = Eigen::Index(axis);
                w.v0[i][c] = owner == kHeld ? 0.0 : prescribed_velocity(body, body.motions[std::size_t(owner)], i, ctx.time_s, h)[c];
                w.base_x[i][c] = second_order ? s.x[i][c] + (h - w.h) * w.v0[i][c] : s.x[i][c];
            }
        }
    });
}

void end_scheme(StepContext& ctx, Body& body) {
    const Integrator integrator = ctx.world.def.solver.integrator;
    Workspace& w = body.work;
    BodyState& s = body.state;
    s.dv2.swap(s.dv1);
    ctx.team.for_range(body.vertices(), kRowChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            s.dv1[i] = free_part(body, i, w.v0[i] - s.v[i]);
            if (integrator == Integrator::bdf2) s.v_previous[i] = s.v[i];
            if (integrator == Integrator::newmark) s.a[i] = free_part(body, i, (w.v0[i] - w.base_v[i]) / w.h);
            s.v[i] = integrator == Integrator::quasi_static ? Vec3(Vec3::Zero()) : w.v0[i];
            s.x_previous[i] = s.x[i];
            s.x[i] = w.base_x[i] + w.h * w.v0[i];
        }
    });
    s.moving[0] = 1;
}

}  // namespace supple
