#pragma once
#include <memory>

#include "supple/mesh/mesh_edit.h"
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

    /// build(edit.mesh) for the mesh of an edit of this one, with all that the edit left alone taken over: the same to the last bit, in a fraction of the time.
    /// Where elements of the edit are too flat to be kept, or what is kept has changed its order, it is build().
    std::shared_ptr<const BodyTemplate> edited(const MeshEdit& edit) const;

    const VolumeMesh& mesh() const;            ///< as simulated: repaired and scaled [m]
    const MeshReport& report() const;          ///< of an edited mesh: made when first asked for
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
