#include "supple/haptics/tool_link.h"

#include <algorithm>

#include "supple/math/polar.h"

namespace supple::haptics {

ToolLink::ToolLink(World& world, HapticLoop& loop, const ToolLinkDef& def) : world_(world), loop_(loop), def_(def), builder_(def.model) {}

ToolLink::~ToolLink() {
    // Only what still lives: a world that was reset has let go of everything.
    if (!collider_) return;
    for (const ColliderId c : world_.colliders())
        if (c == collider_) world_.remove_collider(collider_);
}

void ToolLink::add_tool(const Pose& pose) {
    // Not before the handle has said where it is: a tool that appears inside a body would tear it.
    const LoopDef& loop = loop_.def();
    const double K = loop.coupling.stiffness_n_m, h = world_.def().time_step_s;
    ColliderDef def;
    def.name = "haptic tool";
    def.shape = def_.shape;
    def.pose = pose;
    def.friction = def_.friction;
    def.motion = ColliderMotion::tool;
    // The loop's proxy has no mass and no lag; the less the simulation's tool has of them, the better they agree.
    def.mass_kg = def_.mass_kg > 0 ? def_.mass_kg : 0.1 * K * h * h;
    def.coupling.stiffness_n_m = K;
    def.coupling.damping_n_s_m = 0.1 * K * h;
    def.coupling.max_force_n = loop.max_force_n / loop.force_scale;
    collider_ = world_.add_collider(def);
}

void ToolLink::before_step() {
    loop_.samples().update();
    const ToolSample& s = loop_.samples().front();
    if (!s.placed) return;
    const Pose pose{s.handle_m, s.rotation_wxyz};
    if (!collider_) add_tool(pose);
    world_.move_collider(collider_, pose);
}

const ModelReport& ToolLink::after_step() {
    LocalModel& model = loop_.models().back();
    model.contacts = 0;
    model.step_s = world_.def().time_step_s;
    model.tool_m = loop_.def().origin_m;
    if (collider_) builder_.build(world_, collider_, model, held_);
    model.number = ++number_;
    ready_ = true;
    return builder_.report();
}

std::size_t ToolLink::grab(double reach_m) {
    release();
    if (!collider_) return 0;
    const Pose pose = world_.collider_state(collider_).pose;
    const Mat3 R = rotation_matrix(pose.rotation_wxyz);
    struct Near {
        double d;
        BodyId body;
        std::int32_t vertex;
    };
    std::vector<Near> near;
    for (const BodyId body : world_.bodies()) {
        std::vector<std::int32_t> surface;
        for (const Triangle& t : world_.shape(body).boundary().triangles) surface.insert(surface.end(), t.begin(), t.end());
        std::sort(surface.begin(), surface.end());
        surface.erase(std::unique(surface.begin(), surface.end()), surface.end());
        for (const std::int32_t v : surface) {
            const double d = contact::distance(def_.shape, R.transpose() * (world_.positions(body)[std::size_t(v)] - pose.position_m)).d;
            if (d <= reach_m) near.push_back({d, body, v});
        }
    }
    std::stable_sort(near.begin(), near.end(), [](const Near& a, const Near& b) { return a.d < b.d; });
    if (near.size() > kMostHeld) near.resize(kMostHeld);
    for (const Near& n : near) {
        AttachmentDef def;
        def.body = n.body;
        def.vertices[0] = n.vertex;
        def.collider = collider_;
        held_.push_back({world_.attach(def), n.body, n.vertex});
    }
    return held_.size();
}

void ToolLink::release() {
    for (const HeldPoint& h : held_) {
        try {
            world_.detach(h.attachment);
        } catch (const Error&) {  // went with its body, or with a reset
        }
    }
    held_.clear();
}

void ToolLink::publish() {
    if (ready_) loop_.models().publish();
    ready_ = false;
}

}  // namespace supple::haptics
