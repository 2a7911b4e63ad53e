#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "supple/world/world.h"

namespace supple::io {

/// Writes what a run computes, frame by frame, for other programs. The name decides what:
///   a folder, or FILE.pvd        a VTU file per body and frame, and the list of them that ParaView opens (results.pvd in a folder):
///   positions, and
///                                per vertex displacement_m, velocity_m_s, stress_pa (xx yy zz xy yz zx), von_mises_pa, groups; per element
///                                stress_pa, von_mises_pa, plastic_strain (equivalent, of bodies that flow) and region
///   FILE.vtu                     the same of the last frame (one body only)
///   FILE.obj .ply .stl .off      the deformed surface of all bodies in the last frame; with `every_frame` one file per frame,
///   FILE_000010.ply FILE.gltf .glb               an animation: the surfaces with a morph target per frame, metres, y up where gravity
///   points down
class ResultExport {
public:
    /// @error Error(unsupported) naming what can be written; Error(file_unreadable) where the folder cannot be made
    static std::unique_ptr<ResultExport> open(const std::filesystem::path& target, const World& world, bool every_frame);

    virtual ~ResultExport() = default;
    /// The world as it stands now. Bodies must stay the same from the first frame to the last.
    virtual void add_frame(const World& world) = 0;
    /// Writes what is still to be written.
    virtual void finish() = 0;
};

}  // namespace supple::io
