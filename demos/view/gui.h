#pragma once
#include <imgui.h>

#include <map>
#include <string>

struct GLFWwindow;

namespace supple::demos::view {

/// Dear ImGui on a window: its context, font, style; and where the named controls of the last frame were, so that a script finds them.
class Gui {
public:
    struct Box {
        ImVec2 min, max;     ///< with the label beside it
        float frame = 0;     ///< width without that label
        bool visible = false;
    };

    /// @param scale      of everything: 2 on a screen with twice the usual dots
    /// @param hears      false: the window's mouse and keys go nowhere, a script plays them
    Gui(GLFWwindow* window, float scale, bool hears);
    ~Gui();
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    void begin_backend() const;  ///< then the script may write into ImGui::GetIO(), then ImGui::NewFrame()
    void draw() const;           ///< into framebuffer 0
    float scale() const { return scale_; }

private:
    float scale_;
};

/// The controls of a frame by name.
class Controls {
public:
    /// Call it right after the control. Scrolls to it where a script asks for it.
    void mark(const std::string& name);
    void begin_frame() {
        last_ = std::move(now_);
        now_.clear();
    }
    const std::map<std::string, Gui::Box>& last() const { return last_; }
    void want(const std::string& name) { wanted_ = name; }

private:
    std::map<std::string, Gui::Box> now_, last_;
    std::string wanted_;
};
Controls& controls();  ///< of the one window of the program

// Controls that all panels share. `id` is the name for controls().
bool slider(const char* label, const char* id, double& value, double low, double high, const char* format, const char* help, bool logarithmic = false);
bool percent_slider(const char* label, const char* id, double& part, double low, double high, const char* help);
bool force_slider(double& max_force_n);
bool checkbox(const char* label, const char* id, bool& on, const char* help);
bool button(const char* label, const char* id, const char* help, bool lit = false);
/// A list to choose from: the number of the chosen entry; true where it changed.
template <class Names>
bool choice(const char* label, const char* id, int& chosen, const Names& names, const char* help);
void tooltip(const char* help);
/// A line of plain text that wraps.
void sentence(const std::string& text);
void quiet_sentence(const std::string& text);
bool header(const char* label, bool open_at_first);

template <class Names>
bool choice(const char* label, const char* id, int& chosen, const Names& names, const char* help) {
    const std::string now = chosen >= 0 && chosen < int(names.size()) ? std::string(names[std::size_t(chosen)]) : std::string("-");
    bool changed = false;
    const bool open = ImGui::BeginCombo(label, now.c_str());
    if (open) {
        for (int i = 0; i < int(names.size()); ++i) {
            const std::string name(names[std::size_t(i)]);
            if (ImGui::Selectable(name.c_str(), i == chosen) && i != chosen) {
                chosen = i;
                changed = true;
            }
            controls().mark(std::string(id) + "/" + name);
        }
        ImGui::EndCombo();
    }
    controls().mark(id);
    if (!open) tooltip(help);
    return changed;
}

}  // namespace supple::demos::view
