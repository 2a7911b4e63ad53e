#include "statics.h"

#include <cmath>
#include <stdexcept>

namespace supple::verify {

Where on_plane(int axis, double value) {
    return [=](const Vec3& X) { return std::abs(X[axis] - value) <= 1e-9 * (1e-3 + std::abs(value)); };
}

std::string flags_text(StepFlag flags) {
    std::string text;
    for (const StepFlag flag : kAllStepFlags)
        if ((flags & flag) != StepFlag::none) text += (text.empty() ? "" : ", ") + std::string(name(flag));
    return text.empty() ? "none" : text;
}

Statics::Statics(VolumeMesh mesh, const Material& material, const StaticDef& def)
    : world_([&] {
          WorldDef w;
          w.gravity_m_s2 = def.gravity_m_s2;
          w.time_step_s = 1;
          w.threads = def.threads;
          w.solver.integrator = Integrator::quasi_static;
          w.solver.newton_tolerance = def.tolerance;
          w.solver.preconditioner = def.preconditioner;
          w.solver.cg_max_iterations = 20000;
          return w;
      }()) {
    body_ = world_.add_body({.shape = BodyTemplate::build(std::move(mesh)), .material = material, .density_kg_m3 = def.density_kg_m3});
}

std::vector<std::int32_t> Statics::select(const Where& where) const {
    std::vector<std::int32_t> vertices;
    const auto& X = mesh().vertices;
    for (std::size_t i = 0; i < X.size(); ++i)
        if (where(X[i])) vertices.push_back(std::int32_t(i));
    return vertices;
}

void Statics::hold(const Where& where, Axes axes) { world_.fix(body_, VertexList{select(where)}, axes); }

void Statics::move(const Where& where, const std::vector<Mat34>& maps) {
    Motion motion;
    motion.where = VertexList{select(where)};
    motion.affine.values = maps;
    if (maps.size() > 1)
        for (std::size_t k = 0; k < maps.size(); ++k) motion.affine.times_s.push_back(double(k + 1));
    world_.prescribe(body_, motion);
}

void Statics::load(std::span<const Vec3> forces, const std::vector<double>& factors) {
    for (std::size_t i = 0; i < forces.size(); ++i) {
        if (forces[i].isZero(0)) continue;
        Load load;
        load.where = VertexList{{std::int32_t(i)}};
        load.kind = LoadKind::force_per_vertex;
        for (std::size_t k = 0; k < factors.size(); ++k) {
            if (factors.size() > 1) load.value.times_s.push_back(double(k + 1));
            load.value.values.push_back(factors[k] * forces[i]);
        }
        world_.add_load(body_, load);
    }
}

void Statics::press(const Where& where, const std::vector<double>& pressures_pa) {
    Load load;
    load.where = VertexList{select(where)};
    load.kind = LoadKind::pressure;
    load.amount.values = pressures_pa;
    if (pressures_pa.size() > 1)
        for (std::size_t k = 0; k < pressures_pa.size(); ++k) load.amount.times_s.push_back(double(k + 1));
    world_.add_load(body_, load);
}

void Statics::solve() {
    nodal_stress_.clear();
    const StepReport report = world_.step();
    newton_iterations_ += report.newton_iterations;
    if (report.flags != StepFlag::none) throw std::runtime_error("no equilibrium: " + flags_text(report.flags));
}

Vec3 Statics::displacement(const Where& where) const {
    Vec3 sum = Vec3::Zero();
    const auto vertices = select(where);
    for (const std::int32_t v : vertices) sum += displacement(std::size_t(v));
    return sum / double(vertices.size());
}

std::size_t Statics::nearest(const Vec3& X) const {
    const auto& vertices = mesh().vertices;
    std::size_t best = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i)
        if ((vertices[i] - X).squaredNorm() < (vertices[best] - X).squaredNorm()) best = i;
    return best;
}

std::span<const Voigt> Statics::nodal_stress() const {
    if (nodal_stress_.empty()) nodal_stress_ = world_.stress(body_, {.recovery = Recovery::spr}).cauchy_pa;
    return nodal_stress_;
}

Voigt Statics::stress_at(const Vec3& X) const { return nodal_stress()[nearest(X)]; }

}  // namespace supple::verify
