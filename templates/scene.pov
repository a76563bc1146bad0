{% macro ground_pigment(over) -%}
pigment { {% if ground.pattern %}function { {{ ground.pattern.function }} } color_map { [0 rgb {{ ground.colour }}] [1 rgb {{ ground.pattern.colour }}] } scale {{ ground.pattern.size }}{{ over }}{% else %}rgb {{ ground.colour }}{% endif %} }{% endmacro %}
// {{ title }}
// A scene that shows off {{ stem }}.inc. Render it with: povray {{ stem }}.ini
// Made by lichtenberg {{ version }}. Edit it freely: an edited file is not overwritten.
#version 3.7;

// Two looks: {{ look }} ({% if natural %}soft sun, light from the whole sky that goes on from surface to surface{% else %}soft sun, light from the whole sky{% endif %}), and exact (sharp shadows, constant ambient light; fast).
#ifndef({{ prefix }}_Exact) #declare {{ prefix }}_Exact = 0; #end
{% if natural %}
// How much is spent on light that has been scattered: 0 is a draft, 1 good, 2 final.
#ifndef({{ prefix }}_Quality) #declare {{ prefix }}_Quality = 1; #end
{% endif %}

global_settings {
  assumed_gamma 1.0
#if (!{{ prefix }}_Exact)
  ambient_light 0
{% if natural %}
  radiosity {
{% if natural.leafy %}
    // Among leaves no two places are alike: few directions each, taken over far.
    count 8 + 12*{{ prefix }}_Quality
    error_bound 1.8
    recursion_limit max(1, {{ prefix }}_Quality)
    nearest_count 5
    low_error_factor 0.7
    pretrace_start 0.08
    pretrace_end 0.04/max(1, {{ prefix }}_Quality)
    minimum_reuse 0.015
{% else %}
    count 20 + 30*{{ prefix }}_Quality
    error_bound 1.2 - 0.3*{{ prefix }}_Quality
    recursion_limit 1 + {{ prefix }}_Quality
    nearest_count 8
    low_error_factor 0.6
    pretrace_start 0.08
    pretrace_end 0.02/max(1, {{ prefix }}_Quality)
    minimum_reuse 0.01
{% endif %}
    gray_threshold 0
    max_sample {{ natural.brightest }}
  }
{% endif %}
#end
}

camera {
  {{ camera.kind }}
  location {{ camera.location }}
{% if camera.angle %}
  right x*image_width/image_height
  angle {{ camera.angle }}
{% else %}
  right x*{{ camera.width }}
  up y*{{ camera.width }}*image_height/image_width
{% endif %}
  look_at {{ camera.look_at }}
{% if camera.lens %}
#if (!{{ prefix }}_Exact)
  // What is nearer or farther blurs.
  aperture {{ camera.lens.aperture }}
  focal_point {{ camera.lens.focus }}
  blur_samples {% if natural %}19 + 36*{{ prefix }}_Quality{% else %}55{% endif %}

  confidence 0.95
  variance 1/2000
#end
{% endif %}
}
{% for light in lights %}
#if ({{ prefix }}_Exact)
light_source {
  {{ light.location }}, rgb {{ light.colour }}
{% if light.parallel %}
  parallel point_at <0, 0, 0>
{% endif %}
{% if light.fade %}
  fade_distance {{ light.fade }} fade_power 2
{% endif %}
{% if not light.shadow %}
  shadowless
{% endif %}
}
{% if light.shadow or light.fade %}
#else
light_source {
  {{ light.location }}, rgb {{ light.studio }}
{% if light.parallel %}
  parallel point_at <0, 0, 0>
{% endif %}
{% if light.fade %}
  fade_distance {{ light.fade }} fade_power 2
{% endif %}
{% if not light.shadow %}
  shadowless
{% endif %}
{% if light.across %}
  area_light x*{{ light.across }}, z*{{ light.across }}, 5, 5 adaptive 1 circular orient
{% endif %}
}
{% endif %}
#end
{% endfor %}
{% if not natural %}
#if (!{{ prefix }}_Exact)
// The sky, and what comes back from the ground, as {{ dome|length }} lights: directions and colours.
#declare {{ prefix }}_Dome = array[{{ dome|length }}][2] {
{% for light in dome %}
  { {{ light[0] }}, {{ light[1] }} }{% if not loop.last %},{% endif %}

{% endfor %}
}
#for (I, 0, {{ dome|length - 1 }})
  light_source { {{ prefix }}_Dome[I][0]*{{ extent }}, rgb {{ prefix }}_Dome[I][1] parallel point_at <0, 0, 0> }
#end
#end
{% endif %}
#declare {{ prefix }}_Sky = pigment {
{% if sky.zenith %}
  gradient y
  color_map { [0.5 rgb {{ sky.horizon }}] [1 rgb {{ sky.zenith }}] }
  scale 2 translate -1
{% else %}
  image_map { exr "{{ stem }}-sky.exr" map_type 1 interpolate 2 }
  rotate {{ sky.turn }}*y
{% endif %}
}
{% if natural %}
#if ({{ prefix }}_Exact)
sky_sphere { pigment { {{ prefix }}_Sky } }
#else
// What lights the scene: the sky, and below the horizon what comes back from the ground.
sky_sphere {
  pigment {
    function { select(y, 0.25, 0.75) }
    pigment_map { [0.5 rgb {{ natural.bounce }}/{{ natural.strength }}] [0.5 {{ prefix }}_Sky] }
  }
  emission {{ natural.strength }}
}
// What is seen of it.
sphere {
  0, 1
  texture { pigment { {{ prefix }}_Sky } finish { ambient 0 diffuse 0 emission 1 } }
  hollow no_radiosity no_shadow no_reflection
  scale {{ natural.far }}
  translate {{ camera.location }}
}
#end
{% else %}
sky_sphere { pigment { {{ prefix }}_Sky } }
{% endif %}
{% if air %}
fog {
  fog_type 2
  distance {{ air[0] }}
  fog_offset 0
  fog_alt {{ air[1] }}
  rgb {{ sky.horizon }}
}
{% endif %}
{% if ground %}
{% if ground.radius %}
disc {
  <0, {{ ground.height }}, 0>, y, {{ ground.radius }}
  texture { {{ ground_pigment("") }} finish { ambient {{ ground.ambient }} diffuse {{ ground.diffuse }} } }
{% else %}
// The ground fades into the horizon.
plane {
  y, {{ ground.height }}
  texture {
    spherical
    texture_map {
      [0 pigment { rgb {{ sky.horizon }} } finish { ambient 0 diffuse 0 emission 1 }]
      [{{ ground.fade }} {{ ground_pigment("/" ~ ground.reach) }} finish { ambient {{ ground.ambient }} diffuse {{ ground.diffuse }} }]
    }
    scale {{ ground.reach }}
  }
{% endif %}
  no_shadow
}
{% endif %}
{% if inline %}
#declare {{ prefix }}_Inline = yes;
{% endif %}
#include "{{ stem }}.inc"
{% if not inline %}
{% for object in objects %}
object { {{ object.id }} {{ object.turned }}translate {{ object.id }}_Foot }
{% for place in object.places %}
object { {{ object.id }} {{ place }} }
{% endfor %}
{% endfor %}
{% endif %}
{% if stage %}
// What stands about it.
#include "{{ stage[0] }}.inc"
object { {{ stage[1] }} }
{% endif %}
