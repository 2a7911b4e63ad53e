#pragma once
#include <filesystem>
#include <memory>
#include <string>

#include "demo.h"

namespace supple::demos {

struct OpenedShow {
    std::string name;  ///< of the demo, or the scene file without its ending
    bool is_demo = false;
    std::unique_ptr<Show> show;
};

/// Opens a demo by its name or a scene file by its path.
/// @error Error(invalid_argument) that lists the demos if it is neither; whatever reading the scene throws
OpenedShow open_show(const std::string& scene, const ShowOptions& options);

/// A file of assets/: in $SUPPLE_ASSETS, next to the installed program, or in the source tree, in this order.
/// @error Error(file_unreadable) naming the places it looked in
std::filesystem::path find_asset(const std::string& name);

}  // namespace supple::demos
