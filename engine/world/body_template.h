#pragma once
#include <memory>

#include "supple/mesh/surface.h"
#include "supple/mesh/volume_mesh.h"

namespace supple {

struct TemplateData;  // rest gradients, sparsity pattern, gather maps: world/template_data.h

/// The immutable part of a body, shared by any number of bodies and worlds: mesh, boundary, rest shape, matrix pattern.
class BodyTemplate {
public:
    /// Checks and repairs the mesh (see report()), scales it, and prepares everything that does not move.
    /// @param scale  length multiplier, > 0 (0.01 for a mesh in centimetres)
    /// @error Error(surface_mesh / invalid_argument / unsupported) naming mesh.source
    static std::shared_ptr<const BodyTemplate> build(VolumeMesh mesh, double scale = 1.0);

    const VolumeMesh& mesh() const;            ///< as simulated: repaired and scaled [m]
    const MeshReport& report() const;
    const BoundarySurface& boundary() const;
    const TemplateData& data() const { return *data_; }

    ~BodyTemplate();
    BodyTemplate(const BodyTemplate&) = delete;
    BodyTemplate& operator=(const BodyTemplate&) = delete;

private:
    explicit BodyTemplate(std::unique_ptr<const TemplateData> data);
    std::unique_ptr<const TemplateData> data_;
};

}  // namespace supple
