#include "view/keys.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cctype>
#include <map>

namespace supple::demos::view {
namespace {

void next_colours(Desk& desk) {
    const ColorBy now = desk.frame.color_by.value_or(desk.session.show().color_by());
    desk.frame.color_by = now == ColorBy::stress ? ColorBy::stiffness : now == ColorBy::stiffness ? ColorBy::nothing : ColorBy::stress;
}

void open_neighbour(Desk& desk, std::size_t stride) {
    const auto& demos = all_demos();
    if (demos.empty()) return;
    std::size_t now = 0;
    for (std::size_t i = 0; i < demos.size(); ++i)
        if (demos[i].name == desk.session.name()) now = i;
    desk.wishes.open = demos[(now + stride) % demos.size()].name;
}

}  // namespace

void handle_key(Desk& desk, const KeyPress& pressed) {
    Session& session = desk.session;
    const int key = pressed.key;
    if (key >= GLFW_KEY_1 && key <= GLFW_KEY_9) return desk.choose_tool(std::size_t(key - GLFW_KEY_1));
    switch (key) {
        case GLFW_KEY_SPACE: session.playing = !session.playing; break;
        case GLFW_KEY_PERIOD: desk.wishes.step = true; break;
        case GLFW_KEY_R: desk.wishes.restart = true; break;
        case GLFW_KEY_MINUS:
        case GLFW_KEY_KP_SUBTRACT: session.time_scale = std::max(0.02, session.time_scale / 1.5); break;
        case GLFW_KEY_EQUAL:
        case GLFW_KEY_KP_ADD: session.time_scale = std::min(4.0, session.time_scale * 1.5); break;
        case GLFW_KEY_ESCAPE:
            desk.help = false;
            desk.tool_at_hand().cancel(session.world());
            break;
        case GLFW_KEY_U: desk.wishes.undo = true; break;
        case GLFW_KEY_F: desk.wishes.frame_camera = true; break;
        case GLFW_KEY_M: next_colours(desk); break;
        case GLFW_KEY_E: desk.frame.stress_at = FrameOptions::At((int(desk.frame.stress_at) + 1) % 3); break;
        case GLFW_KEY_W: desk.frame.wireframe = !desk.frame.wireframe; break;
        case GLFW_KEY_G: desk.ground = !desk.ground; break;
        case GLFW_KEY_P: (pressed.shift ? desk.wishes.window_picture : desk.wishes.picture) = true; break;
        case GLFW_KEY_V: desk.wishes.film = true; break;
        case GLFW_KEY_N: open_neighbour(desk, 1); break;
        case GLFW_KEY_B: open_neighbour(desk, all_demos().size() - 1); break;
        case GLFW_KEY_TAB: desk.panels = !desk.panels; break;
        case GLFW_KEY_F1:
        case GLFW_KEY_H: desk.help = !desk.help; break;
        case GLFW_KEY_Q: desk.wishes.quit = desk.wishes.quit || pressed.control; break;
        default: break;
    }
}

int key_code(const std::string& name) {
    static const std::map<std::string, int> kNamed = {{"space", GLFW_KEY_SPACE},   {"f1", GLFW_KEY_F1},         {"tab", GLFW_KEY_TAB},
                                                      {"escape", GLFW_KEY_ESCAPE}, {"period", GLFW_KEY_PERIOD}, {"minus", GLFW_KEY_MINUS},
                                                      {"plus", GLFW_KEY_EQUAL}};
    if (const auto found = kNamed.find(name); found != kNamed.end()) return found->second;
    // GLFW's codes of letters and digits are their capitals in ASCII.
    return name.size() == 1 && std::isalnum(static_cast<unsigned char>(name[0])) ? std::toupper(static_cast<unsigned char>(name[0])) : 0;
}

}  // namespace supple::demos::view
