#include "supple/render/context.h"

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <cstdio>
#include <string_view>

#include "supple/base/error.h"

namespace supple {
namespace {

const char* name_of(ContextPlatform platform) {
    switch (platform) {
        case ContextPlatform::surfaceless:
            return "EGL surfaceless";
        case ContextPlatform::device:
            return "EGL device";
        case ContextPlatform::pbuffer:
            return "EGL pbuffer";
    }
    return "EGL";
}

std::string egl_reason(const char* call) {
    const EGLint code = eglGetError();
    const char* name = "unknown error";
    switch (code) {
        case EGL_SUCCESS:
            name = "no reason given";
            break;
        case EGL_NOT_INITIALIZED:
            name = "EGL_NOT_INITIALIZED";
            break;
        case EGL_BAD_ACCESS:
            name = "EGL_BAD_ACCESS";
            break;
        case EGL_BAD_ALLOC:
            name = "EGL_BAD_ALLOC";
            break;
        case EGL_BAD_ATTRIBUTE:
            name = "EGL_BAD_ATTRIBUTE";
            break;
        case EGL_BAD_CONFIG:
            name = "EGL_BAD_CONFIG";
            break;
        case EGL_BAD_CONTEXT:
            name = "EGL_BAD_CONTEXT";
            break;
        case EGL_BAD_DISPLAY:
            name = "EGL_BAD_DISPLAY";
            break;
        case EGL_BAD_MATCH:
            name = "EGL_BAD_MATCH";
            break;
        case EGL_BAD_PARAMETER:
            name = "EGL_BAD_PARAMETER";
            break;
        default:
            break;
    }
    char text[96];
    std::snprintf(text, sizeof text, "%s failed: %s (0x%04x)", call, name, unsigned(code));
    return text;
}

bool has_word(const char* list, std::string_view word) {
    const std::string_view words = list ? list : "";
    for (std::size_t at = words.find(word); at != std::string_view::npos; at = words.find(word, at + 1)) {
        const std::size_t end = at + word.size();
        if ((at == 0 || words[at - 1] == ' ') && (end == words.size() || words[end] == ' ')) return true;
    }
    return false;
}

/// libepoxy ends the process where it finds no library: look first. The handles stay open, as epoxy's own do.
std::string missing_library() {
    if (!dlopen("libEGL.so.1", RTLD_LAZY | RTLD_LOCAL)) return "libEGL.so.1 cannot be loaded";
    if (!dlopen("libOpenGL.so.0", RTLD_LAZY | RTLD_LOCAL) && !dlopen("libGL.so.1", RTLD_LAZY | RTLD_LOCAL))
        return "neither libOpenGL.so.0 nor libGL.so.1 can be loaded";
    return {};
}

}  // namespace

struct HeadlessContext::Impl {
    ContextPlatform platform = ContextPlatform::surfaceless;
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;
    EGLSurface surface = EGL_NO_SURFACE;
    bool pbuffer = false;
    std::string description;
    std::vector<std::string> failures;

    ~Impl() { clear(); }

    // eglTerminate would end the display for everyone in the process (the handle is shared), so only what is ours is destroyed.
    void clear() {
        if (display == EGL_NO_DISPLAY) return;
        if (context != EGL_NO_CONTEXT) {
            if (eglGetCurrentContext() == context) eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
            eglDestroyContext(display, context);
        }
        if (surface != EGL_NO_SURFACE) eglDestroySurface(display, surface);
        context = EGL_NO_CONTEXT;
        surface = EGL_NO_SURFACE;
        display = EGL_NO_DISPLAY;
    }

    /// @return why it failed; empty if the context is current
    std::string open(ContextPlatform p, const HeadlessContextDef& def) {
        platform = p;
        const char* client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
        if (p == ContextPlatform::surfaceless) {
            if (!has_word(client, "EGL_MESA_platform_surfaceless")) return "EGL_MESA_platform_surfaceless is not offered";
            return start(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr), def, false);
        }
        if (p == ContextPlatform::pbuffer) return start(eglGetDisplay(EGL_DEFAULT_DISPLAY), def, true);
        return open_device(client, def);
    }

    std::string open_device(const char* client, const HeadlessContextDef& def) {
        if (!has_word(client, "EGL_EXT_platform_device")) return "EGL_EXT_platform_device is not offered";
        if (!has_word(client, "EGL_EXT_device_enumeration") && !has_word(client, "EGL_EXT_device_base"))
            return "devices cannot be listed (no EGL_EXT_device_enumeration)";
        EGLDeviceEXT devices[16];
        EGLint count = 0;
        if (!eglQueryDevicesEXT(16, devices, &count)) return egl_reason("eglQueryDevicesEXT");
        if (count == 0) return "there is no EGL device";
        std::string reasons;
        for (EGLint i = 0; i < count; ++i) {
            const std::string reason = start(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr), def, false);
            if (reason.empty()) return {};
            reasons += (i ? "; device " : "device ") + std::to_string(i) + ": " + reason;
        }
        return reasons;
    }

    std::string start(EGLDisplay d, const HeadlessContextDef& def, bool with_pbuffer) {
        if (d == EGL_NO_DISPLAY) return egl_reason("eglGetPlatformDisplay");
        if (!eglInitialize(d, nullptr, nullptr)) return egl_reason("eglInitialize");
        display = d;
        pbuffer = with_pbuffer;
        const std::string reason = make(def);
        if (!reason.empty()) clear();
        return reason;
    }

    std::string make(const HeadlessContextDef& def) {
        if (!eglBindAPI(EGL_OPENGL_API)) return egl_reason("eglBindAPI(OpenGL)");
        EGLConfig config = EGL_NO_CONFIG_KHR;
        if (pbuffer || !has_word(eglQueryString(display, EGL_EXTENSIONS), "EGL_KHR_no_config_context")) {
            const EGLint wanted[] = {EGL_SURFACE_TYPE, pbuffer ? EGL_PBUFFER_BIT : 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
            EGLint count = 0;
            if (!eglChooseConfig(display, wanted, &config, 1, &count)) return egl_reason("eglChooseConfig");
            if (count == 0) return "there is no EGL configuration for OpenGL";
        }
        if (pbuffer) {
            const EGLint size[] = {EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};  // never drawn to: the renderer has its own framebuffer
            surface = eglCreatePbufferSurface(display, config, size);
            if (surface == EGL_NO_SURFACE) return egl_reason("eglCreatePbufferSurface");
        } else if (!has_word(eglQueryString(display, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context")) {
            return "EGL_KHR_surfaceless_context is not offered";
        }
        const EGLint attributes[] = {
            EGL_CONTEXT_MAJOR_VERSION,           def.gl_major, EGL_CONTEXT_MINOR_VERSION, def.gl_minor, EGL_CONTEXT_OPENGL_PROFILE_MASK,
            EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
        context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes);
        if (context == EGL_NO_CONTEXT)
            return egl_reason("eglCreateContext") + " for OpenGL " + std::to_string(def.gl_major) + "." + std::to_string(def.gl_minor) +
                   " core";
        if (!eglMakeCurrent(display, surface, surface, context)) return egl_reason("eglMakeCurrent");
        const auto text = [](GLenum name) {
            const auto* s = reinterpret_cast<const char*>(glGetString(name));
            return std::string(s ? s : "?");
        };
        description = std::string(name_of(platform)) + ": " + text(GL_RENDERER) + ", OpenGL " + text(GL_VERSION);
        return {};
    }
};

HeadlessContext::HeadlessContext(const HeadlessContextDef& def) : impl_(std::make_unique<Impl>()) {
    const std::string missing = missing_library();
    if (missing.empty()) {
        for (const ContextPlatform platform : def.platforms) {
            const std::string reason = impl_->open(platform, def);
            if (reason.empty()) return;
            impl_->failures.push_back(std::string(name_of(platform)) + ": " + reason);
        }
    } else {
        impl_->failures.push_back(missing);
    }
    std::string message = "no OpenGL context without a display could be made.";
    for (const std::string& failure : impl_->failures) message += "\n  " + failure;
    message += "\n  Software rendering needs (Debian): apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri libopengl0 libgl1";
    throw Error(ErrorCode::no_display, "HeadlessContext", message);
}

HeadlessContext::~HeadlessContext() = default;

void HeadlessContext::make_current() {
    eglBindAPI(EGL_OPENGL_API);
    if (!eglMakeCurrent(impl_->display, impl_->surface, impl_->surface, impl_->context))
        throw Error(ErrorCode::no_display, "HeadlessContext.make_current",
                    egl_reason("eglMakeCurrent") + "; a context can be current on one thread only: release() it there first");
}

void HeadlessContext::release() { eglMakeCurrent(impl_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); }

ContextPlatform HeadlessContext::platform() const { return impl_->platform; }
const std::string& HeadlessContext::description() const { return impl_->description; }
const std::vector<std::string>& HeadlessContext::failures() const { return impl_->failures; }

}  // namespace supple
