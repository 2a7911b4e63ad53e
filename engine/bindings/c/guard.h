#pragma once
// What the files of the C interface share.
#include <cstddef>
#include <cstring>
#include <new>
#include <string>
#include <utility>

#include "supple/bindings/c/supple.h"
#include "supple/world/world.h"

struct SuppleWorld {
    supple::World world;
};

namespace supple_c {

using supple::BodyId;
using supple::Error;
using supple::ErrorCode;
using supple::Vec3;

// Fixed room for the text: reporting an error must not fail for want of memory.
inline thread_local char last_error[1024] = "";

inline void remember(const char* text) noexcept {
    std::strncpy(last_error, text, sizeof last_error - 1);
    last_error[sizeof last_error - 1] = '\0';
}

inline SuppleStatus fail(SuppleStatus status, const char* text) noexcept {
    remember(text);
    return status;
}

/// Runs `body`, turning every exception into a status and a text.
template <class Body>
SuppleStatus guarded(Body&& body) noexcept {
    try {
        std::forward<Body>(body)();
        return SUPPLE_OK;
    } catch (const Error& error) {
        return fail(static_cast<SuppleStatus>(error.code()), error.what());
    } catch (const std::bad_alloc&) {
        return fail(SUPPLE_OUT_OF_MEMORY, "out of memory");
    } catch (const std::exception& error) {
        return fail(SUPPLE_INTERNAL_ERROR, error.what());
    } catch (...) {
        return fail(SUPPLE_INTERNAL_ERROR, "an exception of unknown type");
    }
}

[[noreturn]] inline void refuse(const std::string& where, const std::string& message) {
    throw Error(ErrorCode::invalid_argument, where, message);
}

template <class T>
T& required(T* pointer, const char* where, const char* what) {
    if (pointer == nullptr) refuse(where, std::string(what) + " is a null pointer");
    return *pointer;
}

inline Vec3 vec3(const double* v) { return {v[0], v[1], v[2]}; }

inline BodyId id(SuppleBodyId body) {
    BodyId result;
    result.index = body.index;
    result.generation = body.generation;
    return result;
}

}  // namespace supple_c
