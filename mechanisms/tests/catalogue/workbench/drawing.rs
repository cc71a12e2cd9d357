//! Views of the pictures of ready mechanisms.

use mbs_codegen::picture::Shape;
use mechanisms::CATALOGUE;

#[test]
fn views_are_orthonormal() {
    let pictures = CATALOGUE.free().map(|card| card.picture().expect("a text"));
    let shapes: Vec<Shape> = pictures.flat_map(|picture| picture.shapes).collect();
    let views = shapes.iter().filter(|shape| matches!(shape, Shape::View { .. }));
    assert!(views.count() >= 3);
    for shape in &shapes {
        let Shape::View { right, up, .. } = shape else { continue };
        let dot = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        for (found, expected) in [(dot(right, right), 1.0), (dot(up, up), 1.0), (dot(right, up), 0.0)] {
            assert!((found - expected).abs() < 1e-15, "{shape:?}");
        }
    }
}
