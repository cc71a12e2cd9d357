//! Published accelerations of Andrews' squeezer, by all rows and by one coordinate.

use super::*;

/// States of Andrews' squeezer and their accelerations at 0, 0.015 and 0.03 s, from integrations of high order.
const ANDREWS: [[[f64; 7]; 3]; 3] = [
    [
        [
            -0.06171389001427645,
            0.0,
            0.45527981916307037,
            0.22266839016588588,
            0.48736497954384256,
            -0.22266839016588588,
            1.2305474445498212,
        ],
        [0.0; 7],
        [14222.443919954114, -10666.832939965585, 0.0, 0.0, 0.0, 0.0, 0.0],
    ],
    [
        [
            5.655429749991794,
            -5.833796765108832,
            0.42589192575237794,
            0.1640128375726053,
            0.4936765269686444,
            -0.1640128375726053,
            1.208712541909195,
        ],
        [
            441.7019932552524,
            -375.3594971288744,
            46.63421226488548,
            92.03152208827694,
            -9.50151625591751,
            -92.03152208827694,
            33.690628623572316,
        ],
        [
            -39300.234413648875,
            78575.26528361502,
            -41077.7074957535,
            -77904.68012902894,
            6779.740923516637,
            77904.68012902894,
            -26644.709108078736,
        ],
    ],
    [
        [
            15.810771195153707,
            -15.756371058411839,
            0.0408222401196458,
            -0.5347301163420796,
            0.524409965879954,
            0.5347301163420796,
            1.048080741041938,
        ],
        [
            1139.9203022591062,
            -1424.3792951775401,
            11.032911910618594,
            19.29337410503204,
            0.5735699148295025,
            -19.29337410503204,
            0.3231791492491309,
        ],
        [
            -24631.763122874636,
            51850.31963646423,
            324102.6007075786,
            566749.4220009954,
            16743.635418345446,
            -566749.4220009954,
            9826.507801544163,
        ],
    ],
];

/// The states above have 15 digits; a derivative at these rates has ten.
const REFERENCE: f64 = 1e-9;

#[test]
fn andrews_squeezer_accelerates_as_published_with_all_rows_and_with_one_coordinate() {
    let andrews: Andrews = Andrews::default();
    for [q, qd, expected] in &ANDREWS {
        let largest = expected.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        let (qdd, lambda) = solve(&andrews, q, qd, 0.0);
        let (followed, multipliers) = follow(&andrews, q, qd);
        for i in 0..7 {
            assert!((qdd[i] - expected[i]).abs() < REFERENCE * largest, "{i}: {} {}", qdd[i], expected[i]);
            assert!((followed[i] - qdd[i]).abs() < REFERENCE * largest, "{i}: {} {}", followed[i], qdd[i]);
        }
        let largest = lambda.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        for (found, expected) in multipliers.iter().zip(&lambda) {
            assert!((found - expected).abs() < REFERENCE * largest, "{found} {expected}");
        }
    }
}
