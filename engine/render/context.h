#pragma once
#include <memory>
#include <string>
#include <vector>

namespace supple {

enum class ContextPlatform { surfaceless, device, pbuffer };

struct HeadlessContextDef {
    /// Tried in this order. The first two never look at DISPLAY.
    std::vector<ContextPlatform> platforms{ContextPlatform::surfaceless, ContextPlatform::device, ContextPlatform::pbuffer};
    int gl_major = 3, gl_minor = 3;  ///< least version of the core profile
};

/// An OpenGL core context that needs no window and no display server, through EGL. Current on the thread that made it.
/// Renderer needs nothing but a current context: any other one (GLFW, Qt, a game engine's) serves as well.
class HeadlessContext {
public:
    /// @error Error(no_display) with the reason of every platform that failed, and the packages to install
    explicit HeadlessContext(const HeadlessContextDef& def = {});
    ~HeadlessContext();
    HeadlessContext(const HeadlessContext&) = delete;
    HeadlessContext& operator=(const HeadlessContext&) = delete;

    /// Takes the context to the calling thread (release it first on the other one). @error Error(no_display)
    void make_current();
    void release();  ///< no context is current on this thread afterwards

    ContextPlatform platform() const;
    /// e.g. "EGL surfaceless: llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5 (Core Profile) Mesa 22.3.6"
    const std::string& description() const;
    /// One sentence for each platform that was tried before this one and failed; empty if the first one did it.
    const std::vector<std::string>& failures() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace supple
