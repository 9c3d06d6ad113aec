//! Files that are valid glTF and not what exporters usually write.

use super::*;

#[test]
fn a_scene_need_not_have_nodes() {
    let empty = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{}]}"#;
    assert_eq!(warnings(empty), ["the scene has no triangles: there is nothing to see"]);
    let beside = triangle("").replace(r#"[{"nodes":[0]}]"#, r#"[{"nodes":[0]},{"name":"empty"}]"#);
    assert_eq!(scene(&beside).instances.len(), 1);
}

#[test]
fn channels_without_a_node_are_ignored() {
    let animation = |target: &str| {
        let json = format!(
            r#","extensionsUsed":["KHR_animation_pointer"],"animations":[{{"channels":[{{"sampler":0,"target":{target}}}],
            "samplers":[{{"input":0,"output":0}}]}}]"#
        );
        load_json(&triangle(&json))
    };
    let pointer = r#"{"path":"pointer","extensions":{"KHR_animation_pointer":{"pointer":"/nodes/0/scale"}}}"#;
    for target in [r#"{"path":"translation"}"#, pointer] {
        let loaded = animation(target);
        assert_eq!(loaded.scene.instances.len(), 1);
        assert_eq!(loaded.warnings[0].message, "1 animations are not played: the rest pose is shown");
        assert_eq!(loaded.warnings.len(), 1);
    }
}

#[test]
fn an_accessor_of_nothing_is_zeros() {
    let json = r#"{"asset":{"version":"2.0"},"accessors":[{"componentType":5126,"type":"VEC3","count":3}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}]}"#;
    assert_eq!(scene(json).meshes[0].positions, [[0.0; 3]; 3]);
}

#[test]
fn a_buffer_of_nothing_is_an_error_only_where_it_is_read() {
    let json = triangle("").replace(r#"}],"bufferViews""#, r#"},{"byteLength":36}],"bufferViews""#);
    assert_eq!(scene(&json).instances.len(), 1);
    let message = refusal(&json.replace(r#""buffer":0"#, r#""buffer":1"#));
    assert!(message.starts_with("F: buffers[1], which bufferViews[0] reads, has no uri; expected a uri"), "{message}");
}

#[test]
fn integers_may_be_written_as_floats() {
    let json = triangle("").replace(r#""count":3"#, r#""count":3.0"#).replace("5126", "5.126e3");
    assert_eq!(scene(&json).meshes[0].triangles, [[0, 1, 2]]);
    let message = refusal(&triangle("").replace(r#""count":3"#, r#""count":2.5"#));
    assert!(message.contains("2.5"), "{message}");
}

#[test]
fn of_a_key_given_twice_the_last_counts() {
    let json = triangle(r#","scene":7,"scene":0"#);
    assert_eq!(scene(&json).instances.len(), 1);
    let twice = triangle("").replace(r#""asset":"#, r#""asset":{"version":"1.0"},"asset":"#);
    assert_eq!(scene(&twice).instances.len(), 1);
}
