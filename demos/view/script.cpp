#include "view/script.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include "supple/base/error.h"
#include "view/keys.h"

namespace supple::demos::view {
namespace {

constexpr int kFramesToReach = 4;  // a panel needs one to scroll, one to draw; what a header opened, one more

/// Least and most words of a command, its name among them.
const std::map<std::string, std::array<std::size_t, 2>>& grammar() {
    static const std::map<std::string, std::array<std::size_t, 2>> kCommands = {
        {"wait", {2, 2}},  {"move", {3, 4}},  {"press", {2, 2}},   {"release", {2, 2}}, {"scroll", {2, 2}}, {"key", {2, 2}},
        {"click", {2, 9}}, {"slide", {3, 9}}, {"picture", {2, 2}}, {"resize", {3, 3}},  {"drop", {2, 2}},   {"print", {1, 1}}};
    return kCommands;
}

/// Words `from` to before `to` with blanks: names of controls may have some.
std::string joined(const std::vector<std::string>& words, std::size_t from, std::size_t to) {
    std::string text = words[from];
    for (std::size_t i = from + 1; i < to; ++i) text += " " + words[i];
    return text;
}

}  // namespace

Script::Script(const std::filesystem::path& file) : file_(file.string()) {
    std::ifstream in(file);
    if (!in) throw Error(ErrorCode::file_unreadable, file_, "cannot be opened");
    std::string text;
    for (int line = 1; std::getline(in, text); ++line) {
        text = text.substr(0, text.find('#'));
        std::istringstream words(text);
        Command command{line, {}};
        for (std::string word; words >> word;) command.words.push_back(word);
        if (command.words.empty()) continue;
        const auto known = grammar().find(command.words[0]);
        const std::string where = file_ + ":" + std::to_string(line);
        if (known == grammar().end()) {
            std::string names;
            for (const auto& entry : grammar()) names += (names.empty() ? "" : ", ") + entry.first;
            throw Error(ErrorCode::parse, where, "\"" + command.words[0] + "\" is no command; there are " + names);
        }
        if (command.words.size() < known->second[0] || command.words.size() > known->second[1])
            throw Error(ErrorCode::parse, where, "\"" + command.words[0] + "\" takes another number of words");
        commands_.push_back(std::move(command));
    }
}

void Script::fail(const Command& command, const std::string& message) const {
    throw Error(ErrorCode::invalid_argument, file_ + ":" + std::to_string(command.line), message);
}

double Script::number(const Command& command, std::size_t word) const {
    const std::string& text = command.words[word];
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (*end != '\0' || !std::isfinite(value)) fail(command, "\"" + text + "\" is no number");
    return value;
}

void Script::stay(int frames) {
    for (int i = 0; i < frames; ++i) queue_.push_back(now_);
}

/// Moves to the control, presses, and releases; the panel is asked to scroll to it first.
void Script::use_control(const Command& command) {
    const bool slides = command.words[0] == "slide";
    const std::string name = joined(command.words, 1, command.words.size() - (slides ? 1 : 0));
    controls().want(name);
    const auto found = controls().last().find(name);
    const bool in_sight = found != controls().last().end() && found->second.visible;
    if (reached_for_ < kFramesToReach) {
        ++reached_for_;
        reaching_ = &command;
        return stay(1);
    }
    reaching_ = nullptr;
    reached_for_ = 0;
    controls().want("");
    if (!in_sight) {
        std::string names;
        for (const auto& entry : controls().last()) names += (names.empty() ? "" : ", ") + entry.first;
        fail(command, "no control \"" + name + "\" is in sight; there are: " + names);
    }
    const Gui::Box box = found->second;
    const ImVec2 middle(0.5f * (box.min.x + box.max.x), 0.5f * (box.min.y + box.max.y));
    now_.cursor = middle;
    if (!slides && !name.empty()) now_.cursor.x = std::min(middle.x, box.min.x + 20);  // a wide header or a check box with its label
    float goal = now_.cursor.x;
    if (slides) {
        // The frame of a slider without the label beside it; the handle's own width keeps it off the ends.
        const float width = ImGui::GetStyle().GrabMinSize + 4, left = box.min.x + 0.5f * width, right = box.min.x + box.frame - 0.5f * width;
        goal = left + float(number(command, command.words.size() - 1)) * (right - left);
        now_.cursor.x = box.min.x + 0.5f * box.frame;
    }
    stay(2);
    now_.down[0] = true;
    stay(2);
    now_.cursor.x = goal;
    stay(2);
    now_.down[0] = false;
    stay(2);
}

void Script::act(const Command& command, const Viewport& viewport, Window& window) {
    const std::vector<std::string>& w = command.words;
    const auto button = [&] {
        const std::array<const char*, 3> names = {"left", "right", "middle"};
        for (std::size_t i = 0; i < 3; ++i)
            if (w[1] == names[i]) return i;
        fail(command, "\"" + w[1] + "\" is no button; there are left, right and middle");
    };
    if (w[0] == "wait") return stay(std::max(1, int(number(command, 1))));
    if (w[0] == "move") {
        const ImVec2 from = now_.cursor;
        const ImVec2 to(viewport.x + float(number(command, 1)) * viewport.width, viewport.y + float(number(command, 2)) * viewport.height);
        const int frames = w.size() > 3 ? std::max(1, int(number(command, 3))) : 1;
        for (int i = 1; i <= frames; ++i) {
            const float s = float(i) / float(frames);
            now_.cursor = ImVec2(from.x + s * (to.x - from.x), from.y + s * (to.y - from.y));
            stay(1);
        }
        return;
    }
    if (w[0] == "press" || w[0] == "release") now_.down[button()] = w[0] == "press";
    if (w[0] == "key") {
        const bool shift = w[1].rfind("shift+", 0) == 0;
        const int code = key_code(shift ? w[1].substr(6) : w[1]);
        if (code == 0) fail(command, "\"" + w[1] + "\" is no key that this viewer knows");
        window.press({code, shift, false});
    }
    if (w[0] == "picture") picture_ = w[1];
    if (w[0] == "print") prints_ = true;
    if (w[0] == "resize") window.resize(int(number(command, 1)), int(number(command, 2)));
    if (w[0] == "drop") window.drop(w[1]);
    stay(w[0] == "resize" ? 3 : 1);
    if (w[0] == "scroll") queue_.back().wheel = float(number(command, 1));
}

void Script::begin(const Command& command, const Viewport& viewport, Window& window) {
    queue_.clear();
    queue_at_ = 0;
    if (command.words[0] == "click" || command.words[0] == "slide") return use_control(command);
    act(command, viewport, window);
}

void Script::play(const Viewport& viewport, Window& window) {
    picture_.clear();
    prints_ = false;
    if (queue_at_ == queue_.size()) {
        if (reaching_ != nullptr) begin(*reaching_, viewport, window);
        else if (next_ < commands_.size()) begin(commands_[next_++], viewport, window);
    }
    Moment moment = now_;
    if (queue_at_ < queue_.size()) moment = queue_[queue_at_++];
    ImGuiIO& io = ImGui::GetIO();
    io.MousePos = moment.cursor;
    for (std::size_t i = 0; i < 3; ++i) io.MouseDown[i] = moment.down[i];
    io.MouseWheel = moment.wheel;
}

}  // namespace supple::demos::view
