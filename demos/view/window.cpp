#include "view/window.h"

#include <epoxy/gl.h>
// After epoxy: GLFW must not bring in another OpenGL header.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cstdlib>
#include <utility>

#include "supple/base/error.h"

namespace supple::demos::view {
namespace {

std::string reason_of_glfw() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text != nullptr ? text : "GLFW gives no reason";
}

[[noreturn]] void no_window(const std::string& reason) {
    const char* display = std::getenv("DISPLAY");
    throw Error(ErrorCode::no_display, "supple view",
                "no window can be opened: " + reason + " (DISPLAY is " + (display != nullptr ? "\"" + std::string(display) + "\"" : std::string("not set")) +
                    "). Start it in a graphical session or under Xvfb; `supple record` draws without a display");
}

}  // namespace

Window::Window(int width, int height, const std::string& title, bool waits_for_screen) {
    if (!glfwInit()) no_window(reason_of_glfw());
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_SRGB_CAPABLE, GLFW_FALSE);
    glfwWindowHint(GLFW_SAMPLES, 0);  // the renderer has its own framebuffer
    glfwWindowHint(GLFW_DEPTH_BITS, 0);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
    if (window_ == nullptr) {
        const std::string reason = reason_of_glfw();
        glfwTerminate();
        no_window(reason);
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(waits_for_screen ? 1 : 0);
    glfwSetWindowSizeLimits(window_, 480, 360, GLFW_DONT_CARE, GLFW_DONT_CARE);
    glfwSetWindowUserPointer(window_, this);
    glfwSetKeyCallback(window_, [](GLFWwindow* w, int key, int, int action, int mods) {
        if (action != GLFW_RELEASE) static_cast<Window*>(glfwGetWindowUserPointer(w))->press({key, (mods & GLFW_MOD_SHIFT) != 0, (mods & GLFW_MOD_CONTROL) != 0});
    });
    glfwSetDropCallback(window_, [](GLFWwindow* w, int count, const char** paths) {
        for (int i = 0; i < count; ++i) static_cast<Window*>(glfwGetWindowUserPointer(w))->drop(paths[i]);
    });
}

Window::~Window() {
    glfwDestroyWindow(window_);
    glfwTerminate();
}

void Window::poll() const { glfwPollEvents(); }
void Window::show() const { glfwSwapBuffers(window_); }
bool Window::closes() const { return glfwWindowShouldClose(window_) != 0; }
void Window::close() const { glfwSetWindowShouldClose(window_, GLFW_TRUE); }
void Window::resize(int width, int height) const { glfwSetWindowSize(window_, width, height); }
void Window::set_title(const std::string& title) const { glfwSetWindowTitle(window_, title.c_str()); }

float Window::content_scale() const {
    float x = 1, y = 1;
    glfwGetWindowContentScale(window_, &x, &y);
    return x > 0 ? x : 1;
}

void Window::size(int& width, int& height) const { glfwGetWindowSize(window_, &width, &height); }
void Window::pixel_size(int& width, int& height) const { glfwGetFramebufferSize(window_, &width, &height); }
bool Window::is_minimised() const { return glfwGetWindowAttrib(window_, GLFW_ICONIFIED) != 0; }

std::vector<KeyPress> Window::take_keys() { return std::exchange(keys_, {}); }
std::vector<std::string> Window::take_drops() { return std::exchange(drops_, {}); }

}  // namespace supple::demos::view
