//! Numbers in buffers. Every place is checked before it is read.

use gltf_json::accessor::{ComponentType, Type};
use gltf_json::validation::Checked;

use crate::document::Document;
use crate::error::Problem;

/// The numbers of an accessor.
pub(crate) struct Numbers<'d> {
    bytes: &'d [u8],
    stride: usize,
    component: ComponentType,
    count: usize,
}

impl<'d> Numbers<'d> {
    /// Opens an accessor that must have elements of a type.
    fn open(
        document: &'d Document,
        index: usize,
        (kind, wanted): (Type, &'static str),
        components: &[ComponentType],
    ) -> Result<Self, Problem> {
        let accessor = document.root.accessors.get(index).ok_or(Problem::NoData(index))?;
        if accessor.sparse.is_some() {
            return Err(Problem::Sparse(index));
        }
        let layout = || Problem::Layout { accessor: index, wanted };
        let (Checked::Valid(is), Checked::Valid(component)) = (accessor.type_, accessor.component_type)
        else {
            return Err(layout());
        };
        let component = component.0;
        let floats = component == ComponentType::F32;
        if is != kind
            || !components.contains(&component)
            || (!floats && components.contains(&ComponentType::F32) && !accessor.normalized)
        {
            return Err(layout());
        }
        let view = accessor.buffer_view.ok_or(Problem::NoData(index))?.value();
        let beyond = || Problem::OutOfBuffer(index);
        let bytes = document.view(view).ok_or_else(beyond)?;
        let element = component.size() * kind.multiplicity();
        let stride = document.root.buffer_views[view].byte_stride.map_or(element, |stride| stride.0);
        if stride < element {
            return Err(layout());
        }
        let number = |v: u64| usize::try_from(v).map_err(|_| beyond());
        let from = number(accessor.byte_offset.map_or(0, |offset| offset.0))?;
        let count = number(accessor.count.0)?;
        let bytes = bytes.get(from..).ok_or_else(beyond)?;
        let fits = count.checked_sub(1).is_none_or(|last| {
            last.checked_mul(stride)
                .and_then(|at| at.checked_add(element))
                .is_some_and(|end| end <= bytes.len())
        });
        fits.then_some(Self { bytes, stride, component, count }).ok_or_else(beyond)
    }

    /// Places or normals.
    pub(crate) fn vectors(document: &'d Document, index: usize) -> Result<Self, Problem> {
        Self::open(document, index, (Type::Vec3, "list of vectors of three floats"), &[ComponentType::F32])
    }

    /// Places in pictures.
    pub(crate) fn texture_places(document: &'d Document, index: usize) -> Result<Self, Problem> {
        let components = [ComponentType::F32, ComponentType::U8, ComponentType::U16];
        Self::open(
            document,
            index,
            (Type::Vec2, "list of pairs of floats or normalised bytes or words"),
            &components,
        )
    }

    /// Indices of vertices.
    pub(crate) fn indices(document: &'d Document, index: usize) -> Result<Self, Problem> {
        let components = [ComponentType::U8, ComponentType::U16, ComponentType::U32];
        Self::open(document, index, (Type::Scalar, "list of indices"), &components)
    }

    /// Which joints of its skin each vertex hangs on.
    pub(crate) fn joints(document: &'d Document, index: usize) -> Result<Self, Problem> {
        let components = [ComponentType::U8, ComponentType::U16];
        Self::open(document, index, (Type::Vec4, "list of four joints, as bytes or words"), &components)
    }

    /// How much it hangs on each.
    pub(crate) fn weights(document: &'d Document, index: usize) -> Result<Self, Problem> {
        let components = [ComponentType::F32, ComponentType::U8, ComponentType::U16];
        let wanted = "list of four weights, as floats or normalised bytes or words";
        Self::open(document, index, (Type::Vec4, wanted), &components)
    }

    /// Matrices of four by four.
    pub(crate) fn matrices(document: &'d Document, index: usize) -> Result<Self, Problem> {
        Self::open(
            document,
            index,
            (Type::Mat4, "list of matrices of four by four floats"),
            &[ComponentType::F32],
        )
    }

    pub(crate) fn len(&self) -> usize {
        self.count
    }

    fn bytes_of<const N: usize>(&self, element: usize, k: usize) -> Option<[u8; N]> {
        let at = element.checked_mul(self.stride)? + k * N;
        (element < self.count).then(|| self.bytes.get(at..at + N)?.try_into().ok()).flatten()
    }

    /// Component `k` of an element; whole numbers as shares of their largest.
    pub(crate) fn float(&self, element: usize, k: usize) -> Option<f32> {
        match self.component {
            ComponentType::F32 => self.bytes_of(element, k).map(f32::from_le_bytes),
            ComponentType::U8 => self.bytes_of(element, k).map(|[v]| f32::from(v) / 255.0),
            ComponentType::U16 => {
                self.bytes_of(element, k).map(|two| f32::from(u16::from_le_bytes(two)) / 65_535.0)
            }
            _ => None,
        }
    }

    pub(crate) fn triple(&self, element: usize) -> Option<[f32; 3]> {
        Some([self.float(element, 0)?, self.float(element, 1)?, self.float(element, 2)?])
    }

    pub(crate) fn pair(&self, element: usize) -> Option<[f32; 2]> {
        Some([self.float(element, 0)?, self.float(element, 1)?])
    }

    pub(crate) fn index(&self, element: usize) -> Option<u32> {
        self.whole(element, 0)
    }

    /// Component `k` of an element that is a whole number.
    pub(crate) fn whole(&self, element: usize, k: usize) -> Option<u32> {
        match self.component {
            ComponentType::U8 => self.bytes_of(element, k).map(|[v]| u32::from(v)),
            ComponentType::U16 => self.bytes_of(element, k).map(|two| u32::from(u16::from_le_bytes(two))),
            ComponentType::U32 => self.bytes_of(element, k).map(u32::from_le_bytes),
            _ => None,
        }
    }
}
