//! Steps over impacts and frictions: the method of Moreau and Jean against closed forms and located events.

mod balls;
