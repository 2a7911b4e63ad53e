#include "view/session.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <utility>

#include "framing.h"
#include "view/mesh_show.h"

namespace supple::demos::view {
namespace {

/// A scene begins with a brace or a comment; no mesh format does.
bool looks_like_a_scene(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    char first = ' ';
    while (in.get(first) && std::isspace(static_cast<unsigned char>(first))) {}
    return first == '{' || first == '/';
}

}  // namespace

OpenedShow Session::open_any(const std::string& scene) const {
    const auto is_demo = [&](const Demo& demo) { return demo.name == scene; };
    const bool known = std::any_of(all_demos().begin(), all_demos().end(), is_demo);
    if (known || !std::filesystem::is_regular_file(scene) || looks_like_a_scene(scene)) return open_show(scene, options_);
    return {std::filesystem::path(scene).stem().string(), false, open_mesh(scene, options_)};
}

void Session::begin(OpenedShow opened) {
    opened_ = std::move(opened);
    ++openings_;
    pending_s_ = 0;
    alpha_ = 1;
    script_ = true;
    for (Edit& edit : edits_) edit.applied = 1;
    flags_.clear();
    last_ = {};
    hud_.emplace(world());
}

void Session::open(const std::string& scene) {
    OpenedShow opened = open_any(scene);
    source_ = scene;
    solver_.reset();
    gravity_m_s2_.reset();
    edits_.clear();
    begin(std::move(opened));
    down_ = -up_direction(world());
    for (const BodyId body : world().bodies()) edits_.push_back({std::nullopt, 1, world().definition(body).stiffness_factor_per_element});
}

void Session::restart() {
    begin(open_any(source_));
    if (solver_) world().set_solver(*solver_);
    if (gravity_m_s2_) world().set_gravity(*gravity_m_s2_);
    for (std::size_t body = 0; body < edits_.size() && body < world().bodies().size(); ++body) {
        if (edits_[body].material) world().set_material(world().bodies()[body], *edits_[body].material);
        if (edits_[body].factor != 1) apply(body);
    }
}

void Session::step(FrameSteps& frame) {
    if (script_) show().before_step();
    if (before_step_) before_step_(world().def().time_step_s);
    last_ = world().step();
    hud_->add(last_);
    ++frame.steps;
    frame.step_ms += last_.step_ms;
    for (std::size_t s = 0; s < kStageCount; ++s) frame.stage_ms[s] += last_.stage_ms[s];
    frame.iterations += last_.cg_iterations;
    note_flags();
}

void Session::note_flags() {
    for (FlagNote& note : flags_) ++note.quiet;
    for (const StepFlag flag : kAllStepFlags) {
        if ((last_.flags & flag) == StepFlag::none) continue;
        auto note = std::find_if(flags_.begin(), flags_.end(), [&](const FlagNote& n) { return n.flag == flag; });
        if (note == flags_.end()) note = flags_.insert(flags_.end(), FlagNote{flag, 0, 0});
        ++note->steps;
        note->quiet = 0;
    }
}

FrameSteps Session::advance(double real_s) {
    FrameSteps frame;
    if (!playing || !(real_s > 0)) return frame;
    const double h = world().def().time_step_s;
    pending_s_ += real_s * time_scale;
    // The slack of World::advance(): frames of exactly one step must not slip by rounding.
    while (pending_s_ >= h * (1 - 5e-10) && frame.steps < world().def().max_catch_up_steps) {
        step(frame);
        pending_s_ = std::max(0.0, pending_s_ - h);
    }
    if (pending_s_ >= h) {
        const double rest = std::fmod(pending_s_, h);
        frame.dropped_s = (pending_s_ - rest) / time_scale;
        pending_s_ = rest;
    }
    alpha_ = std::clamp(pending_s_ / h, 0.0, 1.0);
    if (frame.steps > 0) frame.iterations /= frame.steps;
    return frame;
}

FrameSteps Session::step_once() {
    FrameSteps frame;
    step(frame);
    pending_s_ = 0;
    alpha_ = 1;
    return frame;
}

void Session::take_over() {
    if (!script_) return;
    show().let_go();
    script_ = false;
}

void Session::set_material(std::size_t body, const Material& material) {
    world().set_material(world().bodies()[body], material);
    grow_to(body);
    edits_[body].material = material;
}

void Session::apply(std::size_t body) {
    const BodyId id = world().bodies()[body];
    std::vector<double> factors = edits_[body].own_factors;
    const std::size_t elements = world().element_young_pa(id).size();
    if (!factors.empty() && factors.size() != elements) {  // its mesh was edited: the definition went along
        factors = world().definition(id).stiffness_factor_per_element;
        for (double& factor : factors) factor /= edits_[body].applied;
    }
    if (factors.empty()) factors.assign(elements, 1.0);
    for (double& factor : factors) factor *= edits_[body].factor;
    world().set_stiffness_factor(id, factors);
    edits_[body].applied = edits_[body].factor;
}

void Session::grow_to(std::size_t body) {
    const std::vector<BodyId> bodies = world().bodies();
    while (edits_.size() <= body) edits_.push_back({std::nullopt, 1, world().definition(bodies.at(edits_.size())).stiffness_factor_per_element});
}

void Session::set_stiffness_factor(std::size_t body, double factor) {
    grow_to(body);
    const double before = std::exchange(edits_[body].factor, factor);
    try {
        apply(body);
    } catch (...) {
        edits_[body].factor = before;
        throw;
    }
}

void Session::set_solver(const SolverDef& solver) {
    world().set_solver(solver);
    solver_ = solver;
}

void Session::set_gravity(const Vec3& gravity_m_s2) {
    world().set_gravity(gravity_m_s2);
    gravity_m_s2_ = gravity_m_s2;
}

}  // namespace supple::demos::view
