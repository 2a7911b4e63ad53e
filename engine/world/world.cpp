#include "supple/world/world.h"

#include <algorithm>
#include <cmath>

#include "supple/base/hash.h"
#include "supple/fem/element_passes.h"
#include "supple/world/impl.h"
#include "supple/world/precondition.h"

namespace supple {

namespace {

template <class T>
void check_count(const char* field, T value, T low, T high, const char* fix) {
    if (value >= low && value <= high) return;
    throw Error(ErrorCode::invalid_argument, std::string("WorldDef.") + field,
                std::to_string(value) + " is outside [" + std::to_string(low) + ", " + std::to_string(high) + "]; " + fix);
}

void check(const WorldDef& def) {
    if (!def.gravity_m_s2.allFinite()) throw Error(ErrorCode::invalid_argument, "WorldDef.gravity_m_s2", "is not finite");
    require_in_range(def.time_step_s, 1e-9, 1, "WorldDef.time_step_s", "1/60 to 1/1000 s is usual");
    check_count("threads", def.threads, 0, 256, "0 takes all cores");
    check_count("max_catch_up_steps", def.max_catch_up_steps, 1, 1000, "4 is usual");
    const SolverDef& s = def.solver;
    check_count("solver.newton_iterations", s.newton_iterations, 0, 1000, "0 leaves it to the integrator: 1, static 100");
    if (!(s.newton_tolerance >= 0 && s.newton_tolerance < 1)) {
        throw Error(ErrorCode::invalid_argument, "WorldDef.solver.newton_tolerance", to_text(s.newton_tolerance) + " is outside [0, 1); 0 does every iteration");
    }
    if (!(s.cg_relative_tolerance > 0 && s.cg_relative_tolerance < 1)) {
        throw Error(ErrorCode::invalid_argument, "WorldDef.solver.cg_relative_tolerance",
                    to_text(s.cg_relative_tolerance) + " is outside (0, 1); 1e-3 for games, 1e-5 for measurements");
    }
    check_count("solver.contact_iterations", s.contact_iterations, 1, 1000, "12 is usual");
    check_count("solver.cg_max_iterations", s.cg_max_iterations, 1, 1000000, "2000 is usual");
    require_in_range(s.step_budget_us, 0, 1e9, "WorldDef.solver.step_budget_us", "0 sets no limit");
    if (def.isa && !is_supported(*def.isa)) {
        throw Error(ErrorCode::unsupported, "WorldDef.isa", std::string(name(*def.isa)) + " is not built in or not in this processor; " + std::string(name(best_isa())) + " is");
    }
    require_in_range(s.rayleigh_mass_1_s, 0, 1e6, "WorldDef.solver.rayleigh_mass_1_s");
    require_in_range(s.rayleigh_stiffness_s, 0, 1e3, "WorldDef.solver.rayleigh_stiffness_s");
}

/// Of the first nearly incompressible material of a body.
void warn_of_locking(const WorldDef& world, const Body& body) {
    if (!world.log) return;
    const VolumeMesh& mesh = body.data().mesh;
    const std::vector<Material>& materials = body.materials.materials;
    const auto locks = [](const Material& material) {
        const Lame lame = small_strain(material);
        return lame.lambda_pa / (2 * (lame.lambda_pa + lame.mu_pa)) > 0.48 + 1e-9 && volumetric_of(material) == Volumetric::element;
    };
    const auto locking = std::find_if(materials.begin(), materials.end(), locks);
    if (!mesh.tets.empty() && locking != materials.end()) {
        const Lame lame = small_strain(*locking);
        world.log(LogLevel::warning, body.name + ": Poisson's ratio " + to_text(lame.lambda_pa / (2 * (lame.lambda_pa + lame.mu_pa))) +
                                         " above 0.48 locks linear tetrahedra: they bend too little; " +
                                         (is_hyperelastic(*locking) ? "use hexahedra" : "set the material's volumetric to \"nodal\""));
    }
}

/// With what `automatic` stands for.
SolverDef resolved(SolverDef solver) {
    const bool is_static = solver.integrator == Integrator::quasi_static;
    if (solver.precision == Precision::automatic) solver.precision = is_static ? Precision::double_ : Precision::single;
    if (solver.tangent == Tangent::automatic) solver.tangent = is_static ? Tangent::exact : Tangent::warped;
    return solver;
}

}  // namespace

Body& World::Impl::body(BodyId id) const {
    if (id.index < slots.size() && slots[id.index].generation == id.generation && slots[id.index].body) return *slots[id.index].body;
    throw Error(ErrorCode::stale_id, "BodyId",
                "body {" + std::to_string(id.index) + ", " + std::to_string(id.generation) + "} is not in this world: it was removed, or never added");
}

World::World(const WorldDef& def) : impl_(std::make_unique<Impl>()) {
    check(def);
    impl_->def = def;
    impl_->def.solver = resolved(def.solver);
    impl_->isa = def.isa.value_or(best_isa());
    impl_->threads = def.threads == 0 ? hardware_threads() : def.threads;
}

World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

std::size_t element_count(const World::Impl& world) {
    std::size_t sum = 0;
    for (const std::uint32_t slot : world.order) sum += world.slots[slot].body->element_count();
    return sum;
}

void need_crew(World::Impl& world) {
    if (!world.crew && world.threads > 1 && element_count(world) >= kMinElementsForThreads) world.crew = std::make_unique<Team>(world.threads);
}

BodyId World::add_body(const BodyDef& def) {
    Impl& w = *impl_;
    std::uint32_t slot = 0;
    while (slot < w.slots.size() && w.slots[slot].body) ++slot;
    auto body = make_body(def, w.def, slot, w.isa);
    if (w.def.log) {
        for (const std::string& sentence : body->data().mesh_report().sentences()) w.def.log(LogLevel::warning, body->name + ": " + sentence);
    }
    warn_of_locking(w.def, *body);
    if (slot == w.slots.size()) w.slots.emplace_back();
    w.slots[slot].body = std::move(body);
    w.order.push_back(slot);
    need_crew(w);
    give_contact_surfaces(w);
    return {slot, w.slots[slot].generation};
}

void World::remove_body(BodyId id) {
    Impl& w = *impl_;
    w.body(id);
    for (Drag& drag : w.drags) {
        if (drag.body == id) drag.generation = 0;
    }
    for (Attachment& attachment : w.attachments) {
        if (attachment.generation == 0 || (attachment.def.body != id && attachment.def.other != id)) continue;
        attachment = Attachment{};
        --w.living_attachments;
    }
    std::erase_if(w.contact_switches, [&](const Impl::ContactSwitch& s) { return s.a == id || s.b == id; });
    w.slots[id.index].body.reset();
    ++w.slots[id.index].generation;
    w.order.erase(std::find(w.order.begin(), w.order.end(), id.index));
}

void World::set_contact(BodyId a, BodyId b, bool on) {
    Impl& w = *impl_;
    for (const BodyId id : {a, b}) w.body(id);
    for (Impl::ContactSwitch& s : w.contact_switches) {
        if ((s.a == a && s.b == b) || (s.a == b && s.b == a)) {
            s.on = on;
            return give_contact_surfaces(w);
        }
    }
    w.contact_switches.push_back({a, b, on});
    give_contact_surfaces(w);
}

void give_contact_surfaces(World::Impl& world) {
    std::size_t sociable = 0;
    for (const std::uint32_t slot : world.order) sociable += world.slots[slot].body->def.touches_bodies;
    for (const std::uint32_t slot : world.order) {
        Body& body = *world.slots[slot].body;
        if (world.living_colliders > 0 || body.def.touches_itself || (body.def.touches_bodies && sociable > 1)) body.need_contact_surface();
    }
    for (const World::Impl::ContactSwitch& s : world.contact_switches) {
        if (!s.on) continue;
        for (const BodyId id : {s.a, s.b}) world.body(id).need_contact_surface();
    }
}

std::vector<BodyId> World::bodies() const {
    std::vector<BodyId> ids;
    for (const std::uint32_t slot : impl_->order) ids.push_back({slot, impl_->slots[slot].generation});
    return ids;
}

const BodyTemplate& World::shape(BodyId id) const { return *impl_->body(id).shape; }
std::shared_ptr<const Skin> World::skin(BodyId id) const { return impl_->body(id).def.skin; }

std::vector<Vec3> World::skin_positions(BodyId id) const {
    const Body& body = impl_->body(id);
    std::vector<Vec3> out;
    if (!body.def.skin) return out;
    out.resize(body.def.skin->embedding().size());
    body.def.skin->embedding().deform(body.state.x, out);
    return out;
}

const std::string& World::name(BodyId id) const { return impl_->body(id).name; }
const BodyDef& World::definition(BodyId id) const { return impl_->body(id).def; }

void World::set_state(BodyId id, std::span<const Vec3> positions_m, std::span<const Vec3> velocities_m_s) {
    Body& body = impl_->body(id);
    const auto check_field = [&](std::span<const Vec3> field, const char* what) {
        if (field.size() != body.vertices()) {
            throw Error(ErrorCode::invalid_argument, "World::set_state",
                        std::to_string(field.size()) + " " + what + " for a body of " + std::to_string(body.vertices()) + " vertices");
        }
        for (std::size_t i = 0; i < field.size(); ++i) {
            if (!field[i].allFinite()) throw Error(ErrorCode::invalid_argument, "World::set_state", std::string(what) + " of vertex " + std::to_string(i) + " is not finite");
        }
    };
    check_field(positions_m, "positions");
    check_field(velocities_m_s, "velocities");
    BodyState& s = body.state;
    s.x.assign(positions_m.begin(), positions_m.end());
    s.v.assign(velocities_m_s.begin(), velocities_m_s.end());
    s.x_previous = s.x;
    for (auto* history : {&s.dv1, &s.dv2}) history->assign(body.vertices(), Vec3::Zero());
    s.moving[0] = 0;
    s.contacts.clear();
    fem::seed_rotations(impl_->team_for(body.element_count()), body.layout(), s.x, s.quaternion);
    body.stress.valid = false;
}

void World::set_material(BodyId id, const Material& material) {
    Body& body = impl_->body(id);
    BodyDef def = body.def;
    def.material = material;
    def.material_per_element.clear();
    def.young_pa_per_element.clear();
    def.poisson_per_element.clear();
    apply_materials(body, def, impl_->def, impl_->isa);
    warn_of_locking(impl_->def, body);
}

void World::set_regions(BodyId id, std::vector<MaterialRegion> regions) {
    Body& body = impl_->body(id);
    BodyDef def = body.def;
    def.regions = std::move(regions);
    apply_materials(body, def, impl_->def, impl_->isa);
    warn_of_locking(impl_->def, body);
}

void World::set_stiffness_factor(BodyId id, std::span<const double> per_element) {
    Body& body = impl_->body(id);
    BodyDef def = body.def;
    def.stiffness_factor_per_element.assign(per_element.begin(), per_element.end());
    apply_materials(body, def, impl_->def, impl_->isa);
}

void World::set_solver(const SolverDef& asked) {
    Impl& w = *impl_;
    WorldDef def = w.def;
    const SolverDef before = def.solver;
    def.solver = asked;
    if (asked.precision == Precision::automatic) def.solver.precision = before.precision;
    if (asked.tangent == Tangent::automatic) def.solver.tangent = before.tangent;
    check(def);
    if (def.solver.integrator != before.integrator || def.solver.precision != before.precision || def.solver.tangent != before.tangent) {
        throw Error(ErrorCode::unsupported, "World::set_solver", "integrator, precision and tangent are chosen with the world; make a new one");
    }
    const bool other_kind = def.solver.preconditioner != before.preconditioner;
    const bool other_matrix = def.solver.rayleigh_mass_1_s != before.rayleigh_mass_1_s || def.solver.rayleigh_stiffness_s != before.rayleigh_stiffness_s;
    for (const std::uint32_t slot : w.order) {
        if (other_kind) change_preconditioner(*w.slots[slot].body, def.solver.preconditioner, w.isa);
        if (other_matrix) drop_preconditioner(*w.slots[slot].body);
    }
    w.def = def;
}

StepReport World::step() noexcept { return do_step(*impl_); }

AdvanceReport World::advance(double real_seconds) noexcept {
    Impl& w = *impl_;
    AdvanceReport report;
    if (real_seconds > 0 && std::isfinite(w.accumulator_s + real_seconds)) w.accumulator_s += real_seconds;  // NaN, infinite and negative clocks add nothing
    const double h = w.def.time_step_s;
    StepFlag flags = StepFlag::none;
    // Half a billionth of a step of slack: frames of exactly one step must not slip by rounding.
    while (w.accumulator_s >= h * (1 - 5e-10) && report.steps < w.def.max_catch_up_steps) {
        report.last = do_step(w);
        flags |= report.last.flags;
        w.accumulator_s = std::max(0.0, w.accumulator_s - h);
        ++report.steps;
    }
    if (w.accumulator_s >= h) {
        const double keep = std::fmod(w.accumulator_s, h);
        report.dropped_s = w.accumulator_s - keep;
        w.accumulator_s = keep;
    }
    report.last.flags = flags;
    report.alpha = std::min(1.0, w.accumulator_s / h);
    return report;
}

double World::time_s() const { return impl_->time_s(); }
std::uint64_t World::step_count() const { return impl_->step; }
const WorldDef& World::def() const { return impl_->def; }

void World::set_gravity(const Vec3& gravity_m_s2) {
    if (!gravity_m_s2.allFinite()) throw Error(ErrorCode::invalid_argument, "World::set_gravity", "gravity is not finite");
    impl_->def.gravity_m_s2 = gravity_m_s2;
}

std::span<const Vec3> World::positions(BodyId id) const { return impl_->body(id).state.x; }
std::vector<Vec3> World::start_positions(BodyId id) const { return impl_->body(id).start.x; }
std::span<const Vec3> World::previous_positions(BodyId id) const { return impl_->body(id).state.x_previous; }
std::span<const Vec3> World::velocities(BodyId id) const { return impl_->body(id).state.v; }
std::span<const double> World::masses(BodyId id) const { return impl_->body(id).mass; }
std::span<const double> World::element_young_pa(BodyId id) const { return impl_->body(id).young_pa; }
std::span<const Vec3> World::reactions(BodyId id) const { return impl_->body(id).state.reaction; }

namespace {

const StressCache& stress_of(World::Impl& w, BodyId id) {
    const Body& body = w.body(id);
    update_stress(body, w.team_for(body.element_count()));
    return body.stress;
}

}  // namespace

std::span<const double> World::von_mises(BodyId id) const { return stress_of(*impl_, id).vertex_von_mises; }
std::span<const Voigt> World::cauchy_stress(BodyId id) const { return stress_of(*impl_, id).vertex; }
std::span<const double> World::element_von_mises(BodyId id) const { return stress_of(*impl_, id).element_von_mises; }
std::span<const Voigt> World::element_cauchy_stress(BodyId id) const { return stress_of(*impl_, id).element; }

std::vector<Voigt> World::plastic_strain(BodyId id) const {
    const Body& body = impl_->body(id);
    const AlignedVector<double>& plastic = body.state.plastic;
    std::vector<Voigt> strain(plastic.empty() ? 0 : body.element_count());
    for (std::size_t e = 0; e < strain.size(); ++e) {
        const std::size_t slot = body.layout().slot[e], block = slot / fem::kBlock, lane = slot % fem::kBlock;
        for (std::size_t k = 0; k < 6; ++k) strain[e][k] = plastic[(block * 6 + k) * fem::kBlock + lane];
    }
    return strain;
}

Energy World::energy() const {
    Energy energy;
    for (const BodyId id : bodies()) {
        energy.elastic_j += stress_of(*impl_, id).energy_j;
        const Body& body = impl_->body(id);
        energy.loads_j += body.loads.dead_potential_j(impl_->time_s(), body.state.x, body.start.x);
        for (std::size_t i = 0; i < body.vertices(); ++i) {
            energy.kinetic_j += 0.5 * body.mass[i] * body.state.v[i].squaredNorm();
            energy.gravity_j -= body.mass[i] * impl_->def.gravity_m_s2.dot(body.state.x[i]);
        }
    }
    return energy;
}

Vec3 World::reaction_n(BodyId id) const {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& r : impl_->body(id).state.reaction) sum += r;
    return sum;
}

Vec3 World::reaction_n(BodyId id, const Selection& where) const {
    const Body& body = impl_->body(id);
    Vec3 sum = Vec3::Zero();
    for (const std::int32_t v : select_some(body.data(), body.name, where, "World::reaction_n")) sum += body.state.reaction[std::size_t(v)];
    return sum;
}

Vec3 World::reaction_n() const {
    Vec3 sum = Vec3::Zero();
    for (const BodyId id : bodies()) sum += reaction_n(id);
    return sum;
}

bool World::is_frozen(BodyId id) const { return impl_->body(id).frozen(); }
void World::unfreeze(BodyId id) { impl_->body(id).state.frozen[0] = 0; }

std::uint64_t World::hash() const {
    Hasher hasher;
    const auto add = [&](const auto& array) { hasher.add_bytes(std::as_bytes(std::span(array.data(), array.size()))); };
    add(std::array{impl_->step});
    for (const BodyId id : bodies()) {
        BodyState::for_each_field(impl_->body(id).state, [&](const char*, const auto& field) { add(field); });
    }
    for (const Drag& drag : impl_->drags) {
        if (drag.generation != 0) add(std::array{drag.target, drag.force});
    }
    for (const Collider& collider : impl_->colliders) {
        if (collider.generation != 0) add(collider.moving());
    }
    for (const Attachment& attachment : impl_->attachments) {
        if (attachment.generation != 0) add(std::array{attachment.anchor, attachment.force});
    }
    return hasher.value();
}

}  // namespace supple
