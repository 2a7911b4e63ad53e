#include <algorithm>
#include <cstdio>

#include "view/gui.h"
#include "view/panels.h"

namespace supple::demos::view {
namespace {

void flags(const Session& session) {
    if (session.flags().empty()) return quiet_sentence("Every step reached its tolerance; no flags.");
    for (const FlagNote& note : session.flags()) {
        const bool now = note.quiet < FlagNote::kLately;
        ImGui::PushStyleColor(ImGuiCol_Text, now ? ImVec4(1.0f, 0.72f, 0.35f, 1) : ImVec4(0.75f, 0.72f, 0.65f, 1));
        char line[96];
        std::snprintf(line, sizeof line, "%.*s: %zu step%s%s", int(name(note.flag).size()), name(note.flag).data(), note.steps, note.steps == 1 ? "" : "s", now ? "" : ", not lately");
        sentence(line);
        ImGui::PopStyleColor();
        sentence(std::string(cure(note.flag)) + ".");
    }
}

}  // namespace

void report_panel(Desk& desk) {
    const bool lately = std::any_of(desk.session.flags().begin(), desk.session.flags().end(), [](const FlagNote& n) { return n.quiet < FlagNote::kLately; });
    if (lately) ImGui::PushStyleColor(ImGuiCol_Header, ImVec4(0.55f, 0.33f, 0.10f, 1));
    const bool open = header(lately ? "Report: look here###Report" : "Report###Report", true);
    if (lately) ImGui::PopStyleColor();
    if (!open) return;
    flags(desk.session);
    World& world = desk.session.world();
    for (const BodyId body : world.bodies()) {
        if (!world.is_frozen(body)) continue;
        if (button(("Unfreeze " + world.name(body)).c_str(), "unfreeze", "lets it go on from where it stands, at rest")) world.unfreeze(body);
    }
    char line[160];
    const Vec3 reaction = world.reaction_n();
    std::snprintf(line, sizeof line, "Supports carry %.4g N.", reaction.norm());
    quiet_sentence(line);
    if (desk.speed < 0.9 * desk.session.time_scale && desk.session.playing)
        quiet_sentence("Slower than asked: the steps and the drawing take longer than the time they show. A looser tolerance or a coarser mesh helps.");
}

}  // namespace supple::demos::view
