#pragma once
#include <memory>
#include <string>
#include <vector>

struct GLFWwindow;

namespace supple::demos::view {

/// A key as the viewer knows it: a GLFW key code.
struct KeyPress {
    int key = 0;
    bool shift = false, control = false;
};

/// The window, its OpenGL context (current on this thread), and what came in through it since the last look.
class Window {
public:
    /// @error Error(no_display) with GLFW's reason
    Window(int width, int height, const std::string& title, bool waits_for_screen);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    GLFWwindow* handle() const { return window_; }
    void poll() const;                     ///< events
    void show() const;                     ///< what was drawn
    bool closes() const;
    void close() const;
    void resize(int width, int height) const;
    void set_title(const std::string& title) const;
    float content_scale() const;           ///< 1 at about 96 dots an inch
    void size(int& width, int& height) const;         ///< in the units of the cursor
    void pixel_size(int& width, int& height) const;   ///< of framebuffer 0
    bool is_minimised() const;

    std::vector<KeyPress> take_keys();
    std::vector<std::string> take_drops();
    void drop(const std::string& file) { drops_.push_back(file); }
    void press(const KeyPress& key) { keys_.push_back(key); }

private:
    GLFWwindow* window_ = nullptr;
    std::vector<KeyPress> keys_;
    std::vector<std::string> drops_;
};

}  // namespace supple::demos::view
