#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "supple/io/scene.h"
#include "supple/world/probe.h"

namespace supple::io {

/// The probes of a scene's bodies, in the order of the file. `world` was made of the scene by build_world().
std::vector<Probe> make_probes(const Scene& scene, const World& world);

/// Readings of probes as comma-separated values, one row per probe and reading:
/// step,time_s,body,probe,peak_von_mises_pa,mean_von_mises_pa,peak_at,over_threshold_s,peak_displacement_m,mean_displacement_m,displaced_s
/// (peak_at: element, or vertex of a probe that holds no element). 17 digits; names with a comma, a quote or a line break are quoted (RFC 4180).
class ProbeTable {
public:
    ProbeTable();
    void add(const World& world, const Probe& probe);  ///< its last reading
    const std::string& text() const { return text_; }
    void write(const std::filesystem::path& file) const;

private:
    std::string text_;
};

}  // namespace supple::io
